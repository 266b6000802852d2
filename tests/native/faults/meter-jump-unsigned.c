/* delta_x is shown without its sign.
 * replaces: meter_end_slip
 * detected by: mirror in default
 */
#include "meter.h"

#include <math.h>

void true_meter_end_slip(struct meter *meter, double time);

void meter_end_slip(struct meter *meter, double time)
{
    true_meter_end_slip(meter, time);
    meter->delta_x = fabs(meter->delta_x);
}
