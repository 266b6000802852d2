#include "series.h"

/* Coefficients of q, of the products that lead to p, and of p, while they grow. */
struct powers {
    const double *of[1 + MOST_PRODUCTS];
    double kept[MOST_PRODUCTS][ORDER]; /* the products; where delta is not whole, p is the first */
};

/* The coefficient j of a product of two powers. */
static double product_of(const double one[], const double other[], int j)
{
    double total = one[0] * other[j];
    for (int i = 1; i <= j; i++) total += one[i] * other[j - i];
    return total;
}

/* The coefficient j of the square of a power, which has half the terms. */
static double square_of(const double one[], int j)
{
    const double middle = one[j / 2] * one[j / 2];
    if (j == 0) return middle;
    double total = one[0] * one[j];
    for (int i = 1; i < (j + 1) / 2; i++) total += one[i] * one[j - i];
    return j % 2 == 0 ? 2.0 * total + middle : 2.0 * total;
}

/* The coefficients j of the chain. */
static void grow_chain(struct powers *it, const struct fall_shape *shape, int j)
{
    for (int n = 0; n < shape->products; n++) {
        const double *one = it->of[shape->chain[n].one], *other = it->of[shape->chain[n].other];
        it->kept[n][j] = one == other ? square_of(one, j) : product_of(one, other, j);
    }
}

/* The coefficient j of p where delta is not whole. */
static double power_at(const double q[], const double p[], double delta, int j)
{
    double total = (delta - (j - 1)) * q[1] * p[j - 1];
    for (int i = 2; i <= j; i++) total += (delta * i - (j - i)) * q[i] * p[j - i];
    return total / (j * q[0]);
}

/* The sum of terms[i] e[j - i], i from 1 to j. */
static double folded(const double terms[], const double e[], int j)
{
    double total = terms[1] * e[j - 1];
    for (int i = 2; i <= j; i++) total += terms[i] * e[j - i];
    return total;
}

void series_expand(const struct fall_shape *shape, const struct expansion *given,
                   double q[ORDER + 1], double e[ORDER])
{
    struct powers powers;
    double slope[ORDER]; /* j p_j */
    q[0] = given->q;
    e[0] = given->fall;
    powers.of[0] = q;
    for (int n = 0; n < MOST_PRODUCTS; n++) powers.of[n + 1] = powers.kept[n];
    powers.kept[0][0] = given->inner;
    grow_chain(&powers, shape, 0);
    const double *p = powers.of[shape->analytic ? shape->products : 1];
    q[1] = given->A * given->driving - given->C * q[0];
    double force = given->pulled - given->S * q[0];
    for (int j = 1; j < ORDER; j++) {
        if (shape->is_hyperbolic) {
            e[j] = -folded(q, e, j) * e[0];
        } else {
            if (shape->analytic)
                grow_chain(&powers, shape, j);
            else
                powers.kept[0][j] = power_at(q, p, shape->delta, j);
            slope[j] = j * p[j];
            e[j] = -folded(slope, e, j) / j;
        }
        const double left = j == 1 ? -given->fallen : e[j - 1];
        q[j + 1] = (given->A * (force - given->D * e[j] - given->D_gained * left) -
                    given->C * q[j] - given->C_gained * q[j - 1]) /
                   (j + 1);
        force = -(given->S * q[j]) / (j + 1);
        if (j == 1) force += given->pulled_gained;
    }
}
