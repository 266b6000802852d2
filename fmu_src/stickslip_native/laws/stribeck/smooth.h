/* Friction that falls smoothly with speed, Stribeck's or hyperbolic: docs/theory.md (1), (4).
 *
 * A slip is a chain of arcs. Where friction is a straight line to rounding they are in closed form:
 * at speeds at which its fall is over, close to steady sliding, and at the beginning from rest where
 * the exponent is not whole. Between they are power series. */
#ifndef STICKSLIP_SMOOTH_H
#define STICKSLIP_SMOOTH_H

#include "law.h"

/* Write why the settings are beyond the range of the law, and return whether they are. */
bool smooth_refuses(const struct settings *settings, struct remark *made);

/* The friction under a normal force [N]. */
void smooth_make(const struct settings *settings, double mu_k_used, double normal,
                 struct smooth *made);

/* The part in which a slip goes on from this speed, upward where it `rises`. One from rest begins
 * under the net force [N], which grows so fast [N/s]. */
void smooth_part(const struct friction *it, double speed, bool rises, double net, double rate,
                 struct part *made);

/* The slip that starts so, or its first part. `net` has the friction at standstill. */
enum refusal smooth_slip(const struct friction *it, int mode, double z, double x_dot, double net,
                         struct arc *made);

#endif
