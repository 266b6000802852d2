/* The peak velocity is the largest and not that of the largest magnitude.
 * replaces: meter_pass_slip
 * detected by: mirror in default
 */
#include "meter.h"

void true_meter_pass_slip(struct meter *meter, double duration, double displacement,
                          double relief, double extreme_velocity);

void meter_pass_slip(struct meter *meter, double duration, double displacement, double relief,
                     double extreme_velocity)
{
    if (extreme_velocity < 0.0) extreme_velocity = 0.0;
    true_meter_pass_slip(meter, duration, displacement, relief, extreme_velocity);
}
