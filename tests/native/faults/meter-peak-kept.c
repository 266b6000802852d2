/* The peak velocity of a slip is kept for the next phase: a field is missing in the reset.
 * replaces: open_phase
 * detected by: x_dot_peak-course in reversals
 */
#include "meter.h"

void true_open_phase(struct meter *meter);
void open_phase(struct meter *meter);

void open_phase(struct meter *meter)
{
    const double peak = meter->peak;
    true_open_phase(meter);
    meter->peak = peak;
}
