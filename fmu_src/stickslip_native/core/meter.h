/* The cycle meter: quantities of the last stick, slip and cycle. docs/theory.md (16). */
#ifndef STICKSLIP_METER_H
#define STICKSLIP_METER_H

#include "numerics.h"

#include <stdbool.h>
#include <stdint.h>

/* Quantities of the last completed stick, slip and cycle. Break-away means stick to slip. Durations
 * are added up arc by arc and never taken as differences of times. */
struct meter {
    double t_stick, t_slip, T;   /* last stick, last slip, between the last two break-aways [s] */
    double delta_x, spring_drop; /* displacement of the last slip, and fall of z over it [m] */
    double x_dot_peak;           /* velocity of largest magnitude in the last slip [m/s] */
    double t_event;              /* time of the last transition [s] */
    int32_t n_slips;             /* completed slips, up to INT32_MAX */
    bool seen_break_away;
    double peak;                 /* of the phase that lasts, as the next four */
    struct sum phase, cycle, displacement, relief;
};

void meter_start(struct meter *meter, double time);

/* Count a time at rest [s]. */
void meter_pass_stick(struct meter *meter, double duration);

/* Count a time of slip [s] with displacement of the mass and relief of the spring [m] and the
 * velocity of largest magnitude [m/s]. */
void meter_pass_slip(struct meter *meter, double duration, double displacement, double relief,
                     double extreme_velocity);

/* Close the stick and open a slip at this time [s]. */
void meter_break_away(struct meter *meter, double time);

/* Close the slip at this time [s]; the next phase follows. */
void meter_end_slip(struct meter *meter, double time);

/* Frequency of the last cycle [Hz], 0 before there is one. */
double meter_frequency(const struct meter *meter);

#endif
