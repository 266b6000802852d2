/* The velocity of an over-damped slip is taken to have no extreme.
 * replaces: turning_time
 * detected by: x-course in overdamped-turn
 */
#include "law.h"

#include <math.h>

double turning_time(const struct arc *arc);

double turning_time(const struct arc *arc)
{
    (void)arc;
    return HUGE_VAL;
}
