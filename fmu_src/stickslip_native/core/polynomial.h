/* Polynomials on 0 <= s <= end: value, first zero and maximum, isolated by Bernstein bounds.
 *
 * A polynomial is its coefficients, that of s^0 first, and their count. On an interval it lies
 * between the least and the largest of its Bernstein coefficients, and it is monotone or convex
 * where these are (Farouki and Rajan, Computer Aided Geometric Design 4, 1987, 191): no zero and no
 * extreme is missed between two points. */
#ifndef STICKSLIP_POLYNOMIAL_H
#define STICKSLIP_POLYNOMIAL_H

#include <stdbool.h>

enum { MOST_COEFFICIENTS = 27 };

struct polynomial {
    const double *coefficients;
    int count; /* up to MOST_COEFFICIENTS */
};

/* The value at s, by Horner's scheme. */
double polynomial_value(struct polynomial it, double s);

/* Value and slope of a struct polynomial at s; a `graph`. */
void polynomial_graph(const void *polynomial, double s, double *value, double *slope);

/* Whether a polynomial that starts above 0 reaches 0 up to `end`, and the first s where it does. */
bool polynomial_first_zero(struct polynomial it, double end, double *zero);

/* The largest value from 0 to `end`. */
double polynomial_highest(struct polynomial it, double end);

#endif
