/* The peak velocity of a slip is searched at its ends only.
 * replaces: coulomb_slip_extreme_velocity
 * detected by: x_dot_peak-exact in default
 */
#include "coulomb_slip.h"

#include <math.h>

double coulomb_slip_extreme_velocity(const struct arc *arc, double tau)
{
    const double now = COULOMB_SLIP_FUNCTIONS.state(arc, tau).x_dot;
    return fabs(now) > fabs(arc->x_dot_start) ? now : arc->x_dot_start;
}
