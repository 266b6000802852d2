/* Slip while the speed stays in a band where friction is a straight line, in closed form.
 *
 * In the direction of the slip the friction at the speed u is intercept + slope u [N], so the
 * equation of slip is Coulomb's with that intercept for the kinetic friction and with the damping
 * c + slope, which may be negative: docs/theory.md (3). */
#ifndef STICKSLIP_BAND_H
#define STICKSLIP_BAND_H

#include "law.h"

extern const struct arc_functions BAND_SLIP_FUNCTIONS;

/* The slip from z [m] and x_dot [m/s] in the direction `mode`. `oscillator` has the damping of the
 * band; `net` is the net force without damping, `kinetic` the friction, both as at standstill [N].
 */
void band_slip_make(const struct oscillator *oscillator, double v, double z, double x_dot, int mode,
                    double net, double kinetic, const struct band *band, struct arc *made);

/* The speed at which the next arc of the same slip starts [m/s], in its band. */
double band_slip_exit_speed(const struct arc *ended);

/* The net force with the friction at standstill at the end [N], for the growth of the spring [m]. */
double band_slip_net_at_end(const struct arc *ended, double growth);

#endif
