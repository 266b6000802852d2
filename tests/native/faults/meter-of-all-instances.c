/* All instances count in one cycle meter, a variable of the file.
 * replaces: meter_pass_stick, meter_pass_slip, meter_break_away
 * detected by: two-instances-to-the-bit in default
 */
#include "meter.h"

void true_meter_pass_stick(struct meter *meter, double duration);
void true_meter_pass_slip(struct meter *meter, double duration, double displacement,
                          double relief, double extreme_velocity);
void true_meter_break_away(struct meter *meter, double time);

static struct sum phase;

void meter_pass_stick(struct meter *meter, double duration)
{
    meter->phase = phase;
    true_meter_pass_stick(meter, duration);
    phase = meter->phase;
}

void meter_pass_slip(struct meter *meter, double duration, double displacement, double relief,
                     double extreme_velocity)
{
    meter->phase = phase;
    true_meter_pass_slip(meter, duration, displacement, relief, extreme_velocity);
    phase = meter->phase;
}

void meter_break_away(struct meter *meter, double time)
{
    true_meter_break_away(meter, time);
    phase = meter->phase;
}
