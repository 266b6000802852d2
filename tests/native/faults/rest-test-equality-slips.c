/* The mass breaks away when the force equals the break-away force, without exceeding it.
 * replaces: direction_from_rest
 * detected by: equal-bits in 100 sequences
 */
#include "sticking.h"

#include <math.h>

int direction_from_rest(double spring, double external, double break_away)
{
    const double force = spring + external;
    if (fabs(force) < break_away) return 0;
    return force > 0.0 ? 1 : -1;
}
