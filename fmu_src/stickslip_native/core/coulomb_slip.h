/* Slip under constant kinetic friction, in closed form: docs/theory.md (3), (5), (8). */
#ifndef STICKSLIP_COULOMB_SLIP_H
#define STICKSLIP_COULOMB_SLIP_H

#include "law.h"

extern const struct arc_functions COULOMB_SLIP_FUNCTIONS;

/* The slip from z [m] and x_dot [m/s] in the direction `mode` under the net force [N]. */
void coulomb_slip_make(const struct oscillator *oscillator, double v, double z, double x_dot,
                       int mode, double net, double kinetic, struct arc *made);

/* What the force lacks of F_s at the end, in the direction of the slip [N], known without the
 * difference of two large forces; `gap` is F_s less kinetic friction [N]. */
double coulomb_slip_way_to_break_away(const struct arc *slip, double gap);

#endif
