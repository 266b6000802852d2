#include "meter.h"

#include <math.h>

static const struct sum ZERO = {0.0, 0.0};

/* Nothing of the next phase was passed. */
static void open_phase(struct meter *meter)
{
    meter->phase = ZERO;
    meter->displacement = ZERO;
    meter->relief = ZERO;
    meter->peak = 0.0;
}

void meter_start(struct meter *meter, double time)
{
    *meter = (struct meter){.t_event = time};
}

void meter_pass_stick(struct meter *meter, double duration)
{
    meter->phase = sum_with(meter->phase, duration);
    meter->cycle = sum_with(meter->cycle, duration);
}

void meter_pass_slip(struct meter *meter, double duration, double displacement, double relief,
                     double extreme_velocity)
{
    meter->phase = sum_with(meter->phase, duration);
    meter->cycle = sum_with(meter->cycle, duration);
    meter->displacement = sum_with(meter->displacement, displacement);
    meter->relief = sum_with(meter->relief, relief);
    if (fabs(extreme_velocity) > fabs(meter->peak)) meter->peak = extreme_velocity;
}

void meter_break_away(struct meter *meter, double time)
{
    meter->t_stick = meter->phase.high;
    if (meter->seen_break_away) meter->T = meter->cycle.high;
    meter->seen_break_away = true;
    meter->cycle = ZERO;
    meter->t_event = time;
    open_phase(meter);
}

void meter_end_slip(struct meter *meter, double time)
{
    meter->t_slip = meter->phase.high;
    meter->delta_x = meter->displacement.high;
    meter->spring_drop = meter->relief.high;
    meter->x_dot_peak = meter->peak;
    if (meter->n_slips < INT32_MAX) meter->n_slips++;
    meter->t_event = time;
    open_phase(meter);
}

double meter_frequency(const struct meter *meter)
{
    return meter->T > 0.0 ? 1.0 / meter->T : 0.0;
}
