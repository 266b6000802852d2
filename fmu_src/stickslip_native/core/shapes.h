/* Two shapes of friction over speed.
 *
 * With q = u/v_s the friction of slip is N [mu_k + (mu_s - mu_k) e(q)], and e falls from 1:
 * exp(-q^delta) is Stribeck's shape, 1/(1 + q) the hyperbolic one. */
#ifndef STICKSLIP_SHAPES_H
#define STICKSLIP_SHAPES_H

#include <stdbool.h>

/* For an exponent up to 8. */
enum { MOST_PRODUCTS = 4 };

/* A product of two powers of q, by their positions: 0 is q itself, then come the products. */
struct product {
    int one, other;
};

/* A shape of friction that falls smoothly with q, the speed over v_s. */
struct fall_shape {
    bool is_hyperbolic, analytic; /* whether the series hold at q = 0 */
    int products;
    struct product chain[MOST_PRODUCTS]; /* that make q^delta, where delta is whole */
    double delta;
    double flat_from; /* q from which on nothing of the fall is left */
    double breadth;   /* q over which the slope changes, at least */
};

/* The shape of an exponent, or the hyperbolic one. */
void fall_shape_make(bool is_hyperbolic, double delta, struct fall_shape *made);

/* q^delta, infinity beyond the range; q of the hyperbolic shape. */
double shape_inner(const struct fall_shape *it, double q);

/* e(q), 1 - e(q) and -e'(q). */
double shape_left(const struct fall_shape *it, double q);
double shape_fallen(const struct fall_shape *it, double q);
double shape_steepness(const struct fall_shape *it, double q);

#endif
