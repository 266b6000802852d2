#include "shapes.h"

#include <math.h>

/* Exponents up to this one are chains of products where they are whole. */
static const double MOST_WHOLE = 8.0;

/* -ln of the part of friction that is nothing beside the whole: 2^-52. */
static const double GONE = 36.05;

/* Beyond it the exponential is 0. */
static const double MOST = 700.0;

/* The products that make q^exponent, by its binary digits from the highest down. */
static int products_of(int exponent, struct product chain[MOST_PRODUCTS])
{
    int digit = 1, count = 0;
    while (2 * digit <= exponent) digit *= 2;
    for (digit /= 2; digit > 0; digit /= 2) {
        chain[count] = (struct product){count, count};
        count++;
        if (exponent / digit % 2 == 1) {
            chain[count] = (struct product){count, 0};
            count++;
        }
    }
    return count;
}

void fall_shape_make(bool is_hyperbolic, double delta, struct fall_shape *made)
{
    *made = (struct fall_shape){
        .is_hyperbolic = is_hyperbolic, .analytic = true, .flat_from = HUGE_VAL, .breadth = 1.0};
    if (is_hyperbolic) return;
    made->delta = delta;
    made->analytic = delta <= MOST_WHOLE && delta == floor(delta);
    made->flat_from = pow(GONE, 1.0 / delta);
    made->breadth = 1.0 / delta;
    if (made->analytic) made->products = products_of((int)delta, made->chain);
}

double shape_inner(const struct fall_shape *it, double q)
{
    if (it->is_hyperbolic || it->delta == 1.0) return q;
    if (it->delta == 2.0) return q * q;
    if (q > 1.0 && it->delta * log(q) > MOST) return HUGE_VAL;
    return pow(q, it->delta);
}

double shape_left(const struct fall_shape *it, double q)
{
    return it->is_hyperbolic ? 1.0 / (1.0 + q) : exp(-shape_inner(it, q));
}

double shape_fallen(const struct fall_shape *it, double q)
{
    return it->is_hyperbolic ? q / (1.0 + q) : -expm1(-shape_inner(it, q));
}

double shape_steepness(const struct fall_shape *it, double q)
{
    if (it->is_hyperbolic) return 1.0 / (1.0 + q) / (1.0 + q);
    if (q <= 0.0) return it->delta == 1.0 ? 1.0 : 0.0;
    const double inner = shape_inner(it, q);
    return inner < MOST ? it->delta * (inner / q) * exp(-inner) : 0.0;
}
