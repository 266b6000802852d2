/* A piece of a slip under friction that falls smoothly with speed, as power series of the time.
 *
 * In the direction of the slip, with q = u/v_s, the shape e(q) (shapes.h), the drop of friction
 * D = N (mu_s - mu_k) and the net force at standstill R = s (k z + F_ext) - mu_s N,
 *
 *     m u' = R + D (1 - e) - c u,   R' = k (s v - u).
 *
 * The series (series.h) run in s = tau/H, H the shortest time of the motion at the start. The piece
 * ends where the speed reaches 0, or where the last terms of the series of speed or friction are no
 * longer below rounding. There the slope of the speed is compared with the force of the law itself,
 * and the piece is shortened until they agree. */
#ifndef STICKSLIP_PIECE_H
#define STICKSLIP_PIECE_H

#include "law.h"

extern const struct arc_functions PIECE_FUNCTIONS;

/* The friction without its viscous part at a speed [N]. */
double smooth_friction(const struct smooth *it, double speed);

/* The piece from z [m] and x_dot [m/s] in the direction `mode`; `net` is the force on the mass but
 * for the damping, as if it had the friction at standstill [N]. */
enum refusal piece_make(const struct smooth *law, double z, double x_dot, int mode, double net,
                        struct arc *made);

/* The speed at the end, where the next piece starts [m/s]. */
double piece_exit_speed(const struct arc *ended);

/* The net force with the friction at standstill at the end [N], for the growth of the spring [m]. */
double piece_net_at_end(const struct arc *ended, double growth);

/* What the force lacks of F_s at the end, in the direction of the slip [N]. */
double piece_way_to_break_away(const struct arc *ended, double gap);

#endif
