/* A sum that lies half way between two doubles is rounded by its first two parts alone.
 * replaces: exact_sum
 * detected by: equal-bits in 3000 sequences
 */
#include "numerics.h"

double true_exact_sum(const double terms[], int count);

double exact_sum(const double terms[], int count)
{
    struct sum total = {0.0, 0.0};
    for (int n = 0; n < count; n++) total = sum_with(total, terms[n]);
    return total.high;
}
