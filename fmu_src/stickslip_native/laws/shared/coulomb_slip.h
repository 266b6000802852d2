/* Slip under constant kinetic friction, in closed form: docs/theory.md (3), (5), (8). */
#ifndef STICKSLIP_COULOMB_SLIP_H
#define STICKSLIP_COULOMB_SLIP_H

#include "law.h"
#include "numerics.h"

extern const struct arc_functions COULOMB_SLIP_FUNCTIONS;

/* What laws share whose slip obeys the same equation, with another end. */

/* A slip but for its end and the time of its peak. */
void coulomb_slip_begin(const struct oscillator *oscillator, double v, double z, double x_dot,
                        int mode, double net, double kinetic, struct arc *made);

/* When the slip first comes to rest, or infinity: (5). Sets the time of the peak. */
double coulomb_slip_find_end(struct arc *slip);

/* The speed along the slip [m/s] and its slope [m/s2] at tau [s]; a `graph`, of an arc. */
void coulomb_slip_speed(const void *arc, double tau, double *value, double *slope);

/* When the acceleration changes sign, or infinity, for a >= w: (5). */
double coulomb_slip_turning_time(const struct arc *slip);

/* The slip from z [m] and x_dot [m/s] in the direction `mode` under the net force [N]. */
void coulomb_slip_make(const struct oscillator *oscillator, double v, double z, double x_dot,
                       int mode, double net, double kinetic, struct arc *made);

/* The functions of the table above. */
void coulomb_slip_start(const struct arc *arc, struct start *start);
struct motion coulomb_slip_state(const struct arc *arc, double tau);
struct motion coulomb_slip_end(const struct arc *arc);
double coulomb_slip_pull_work(const struct arc *arc, double tau);
double coulomb_slip_heat(const struct arc *arc, double tau, double displacement);
double coulomb_slip_extreme_velocity(const struct arc *arc, double tau);

/* What the force lacks of F_s at the end, in the direction of the slip [N], known without the
 * difference of two large forces; `gap` is F_s less kinetic friction [N]. */
double coulomb_slip_way_to_break_away(const struct arc *slip, double gap);

#endif
