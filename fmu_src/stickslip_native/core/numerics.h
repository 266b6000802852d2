/* Numerics that know no friction: compensated and exact sums, a bracketed root, quadrature. */
#ifndef STICKSLIP_NUMERICS_H
#define STICKSLIP_NUMERICS_H

#include <stdbool.h>

/* The unevaluated sum high + low, with abs(low) <= ulp(high) / 2: about 32 digits. */
struct sum {
    double high, low;
};

/* The sum with one more term.
 * Source: Knuth, The Art of Computer Programming, vol. 2, 4.2.2, theorem B. */
struct sum sum_with(struct sum total, double term);

/* Whether the second number is what rounding left of the first, as sum_with leaves it. */
bool is_sum(struct sum parts);

/* The sum of finite terms, rounded once.
 * Source: Shewchuk, Adaptive precision floating-point arithmetic, 1997,
 * doi 10.1007/PL00009321. */
double exact_sum(const double terms[], int count);

/* A value and its slope at `at`. */
typedef void graph(const void *context, double at, double *value, double *slope);

/* The zero of a function that falls from above zero at `low` to below it at `high`.
 *
 * Newton's method kept inside the bracket: where a step would leave it, or would not halve the
 * step before the last, the bracket is halved instead (Press et al., Numerical Recipes, 3rd ed.,
 * 9.4). Only the value's sign decides where the zero lies, so an inexact slope costs steps and not
 * digits. */
double falling_zero(graph *function, const void *context, double low, double high);

/* The integral of a function's value from `start` to `end`, by the Gauss-Legendre rule of 16 points.
 */
double integral(graph *function, const void *context, double start, double end);

#endif
