/* The second number of a running sum may be larger than what rounding leaves.
 * replaces: is_sum
 * detected by: damaged-states
 */
#include "numerics.h"

bool is_sum(struct sum parts)
{
    (void)parts;
    return true;
}
