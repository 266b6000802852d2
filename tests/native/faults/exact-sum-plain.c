/* The sum that is rounded once is a loop of additions.
 * replaces: exact_sum
 * detected by: equal-bits in 200 sequences
 */
#include "numerics.h"

double exact_sum(const double terms[], int count)
{
    double total = 0.0;
    for (int n = 0; n < count; n++) total += terms[n];
    return total;
}
