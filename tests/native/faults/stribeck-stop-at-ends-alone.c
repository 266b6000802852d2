/* A stop is looked for at the ends of pieces alone.
 * law: stribeck
 * replaces: polynomial_first_zero
 * detected by: equal-bits in 200 sequences
 */
#include "polynomial.h"

bool true_polynomial_first_zero(struct polynomial it, double end, double *zero);

bool polynomial_first_zero(struct polynomial it, double end, double *zero)
{
    return polynomial_value(it, end) <= 0.0 && true_polynomial_first_zero(it, end, zero);
}
