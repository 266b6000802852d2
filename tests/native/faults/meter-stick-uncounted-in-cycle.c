/* Time at rest is not counted into the period.
 * replaces: meter_pass_stick
 * detected by: T-exact in default
 */
#include "meter.h"

void meter_pass_stick(struct meter *meter, double duration)
{
    meter->phase = sum_with(meter->phase, duration);
}
