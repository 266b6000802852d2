/* Friction over a curve of measured points, straight between them: docs/theory.md (1), (4).
 *
 * A slip is a chain of arcs, one for each band of speeds that it passes. A speed at an end of two
 * bands belongs to the one into which it moves; a speed that stays there belongs to the lower. */
#ifndef STICKSLIP_CURVE_H
#define STICKSLIP_CURVE_H

#include "law.h"

/* Number and names of points: point 1 has mu_1 alone, the others u and mu. */
double curve_speed(const struct settings *settings, int point);
double curve_coefficient(const struct settings *settings, int point);

/* Write why the points are no curve, and return whether they are none. */
bool curve_refuses(const struct settings *settings, struct remark *made);

/* Write which parameter of a point beyond the last is set, and return whether one is. */
bool curve_ignores(const struct settings *settings, struct remark *made);

/* The bands of the curve under a normal force [N]. */
void curve_make(const struct settings *settings, double normal, struct curve *made);

/* The part in which a slip goes on from this speed, upward where it `rises`. */
void curve_part(const struct friction *it, double speed, bool rises, struct part *made);

/* The slip that starts so. `net` has the friction at standstill. */
enum refusal curve_slip(const struct friction *it, int mode, double z, double x_dot, double net,
                        struct arc *made);

#endif
