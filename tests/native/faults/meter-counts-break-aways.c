/* A slip is counted when it begins, so n_slips is one ahead while it lasts.
 * replaces: meter_break_away, meter_end_slip
 * detected by: n_slips-course in default
 */
#include "meter.h"

void true_meter_break_away(struct meter *meter, double time);
void true_meter_end_slip(struct meter *meter, double time);

void meter_break_away(struct meter *meter, double time)
{
    true_meter_break_away(meter, time);
    meter->n_slips++;
}

void meter_end_slip(struct meter *meter, double time)
{
    true_meter_end_slip(meter, time);
    meter->n_slips--;
}
