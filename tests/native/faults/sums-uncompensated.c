/* Running sums are plain additions: what rounding leaves is lost.
 * replaces: sum_with
 * detected by: equal-bits in 200 sequences
 */
#include "numerics.h"

struct sum sum_with(struct sum total, double term)
{
    return (struct sum){total.high + term, 0.0};
}
