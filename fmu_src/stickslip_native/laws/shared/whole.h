/* Friction laws without a stick, whose own state moves with the mass: arcs that are strides of the
 * extrapolated method, and what counts as a cycle: docs/theory.md (33).
 *
 * In an arc the velocity keeps its sign, and the spring grows (mode 0 for the meter) or falls. */
#ifndef STICKSLIP_WHOLE_H
#define STICKSLIP_WHOLE_H

#include "law.h"

extern const struct arc_functions WHOLE_FUNCTIONS;

/* Answers for `struct law`. */
enum refusal whole_begin(const struct friction *it, int mode, double z, double x_dot, double age,
                         const struct own *own, struct arc *begun);
enum refusal whole_after(const struct friction *it, const struct arc *ended, double z,
                         struct arc *following);
enum refusal whole_arc(const struct friction *it, const struct start *start, struct arc *made);
double whole_hold(const struct friction *it, double age);
bool whole_same_slip(const struct friction *one, const struct friction *other);

/* Speed of a unit of motion, and how it changes. */
struct speed {
    double x_dot, x_ddot; /* [m/s], [m/s2] */
};

/* What a law answers. The first unknown is the growth of the spring [m] since the start of the arc,
 * the first sum the integral of that [m.s], the second the heat [J]. */

/* The medium of friction `it`, for the member `of`. */
const struct medium *medium_of(const struct friction *it);

/* The own state at the start of a run, and where a setting changed. */
struct own medium_own(const struct friction *it);
struct own medium_changed(const struct friction *it, struct own before);

/* Unknowns of a mass that starts so. */
void medium_start(struct medium *it, double z, double x_dot, const struct own *own,
                  double y[COLUMNS]);
void medium_field(const void *whole, const double y[COLUMNS], double rates[COLUMNS],
                  double slopes[COLUMNS][UNKNOWNS]);
bool medium_reach(const void *whole, const double from[COLUMNS], const double to[COLUMNS]);
void medium_scales(const struct medium *it, struct system *system);
struct speed medium_speed(const struct medium *it, const double y[COLUMNS],
                          const double rates[COLUMNS]);
/* Velocities below which the sign of one does not act on the motion [m/s]. */
double medium_least_speed(const struct medium *it);
/* Friction on the mass [N], and the own state. */
double medium_friction(const struct whole *it, const double y[COLUMNS], double *own);

#endif
