/* The velocity of an over-damped slip is taken to have no extreme.
 * replaces: coulomb_slip_turning_time
 * detected by: x-course in overdamped-turn
 */
#include "coulomb_slip.h"

#include <math.h>

double coulomb_slip_turning_time(const struct arc *arc)
{
    (void)arc;
    return HUGE_VAL;
}
