/* The peak velocity of a piece is that of its ends.
 * law: stribeck
 * replaces: polynomial_highest
 * detected by: x_dot_peak-course in speeds-stribeck
 */
#include "polynomial.h"

double polynomial_highest(struct polynomial it, double end)
{
    const double last = polynomial_value(it, end);
    return last > it.coefficients[0] ? last : it.coefficients[0];
}
