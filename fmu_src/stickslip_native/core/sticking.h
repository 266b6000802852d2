/* What friction laws with a stick share: rest test, load-up, transitions. docs/theory.md (4), (6).
 */
#ifndef STICKSLIP_STICKING_H
#define STICKSLIP_STICKING_H

#include "law.h"

extern const struct arc_functions STICK_FUNCTIONS;

/* What the rest test forgives [N]. */
double rest_slack(double spring, double external, double break_away);

/* 0 if the mass stays at rest, or the sign of the slip that starts: (4).
 * Spring force k z, external force and break-away force [N]. */
int direction_from_rest(double spring, double external, double break_away);

/* Answers for `struct law`. */
enum refusal sticking_begin(const struct friction *it, int mode, double z, double x_dot, double age,
                            const struct own *own, struct arc *begun);
enum refusal sticking_after(const struct friction *it, const struct arc *ended, double z,
                            struct arc *following);
enum refusal sticking_arc(const struct friction *it, const struct start *start, struct arc *made);
double sticking_hold(const struct friction *it, double age);

#endif
