#include "polynomial.h"

#include "numerics.h"

#include <math.h>

/* An interval this much shorter than the whole one is not divided again: 2^-40. */
static const double NARROW = 9.094947017729282e-13;

/* What rounding may take from a sum of all terms, relative: 2^-40. */
static const double MARGIN = 1.0 + 9.094947017729282e-13;

/* Intervals that wait: each division adds one, and 41 divisions make an interval narrow. Only of an
 * interval near the least number, whose half rounds to nothing, could there be more. */
enum { MOST_WAITING = 48 };

/* A part of the whole interval with the Bernstein coefficients on it. */
struct part {
    double low, high;
    double bounds[MOST_COEFFICIENTS];
};

double polynomial_value(struct polynomial it, double s)
{
    double total = 0.0;
    for (int position = it.count - 1; position >= 0; position--)
        total = total * s + it.coefficients[position];
    return total;
}

void polynomial_graph(const void *polynomial, double s, double *value, double *slope)
{
    const struct polynomial *it = polynomial;
    double total = 0.0, rise = 0.0;
    for (int position = it->count - 1; position >= 0; position--) {
        rise = rise * s + total;
        total = total * s + it->coefficients[position];
    }
    *value = total;
    *slope = rise;
}

/* Whether the first coefficient is larger than all that the others can take from it. */
static bool stays_above(struct polynomial it, double end)
{
    double taken = 0.0;
    for (int position = it.count - 1; position > 0; position--) {
        if (it.coefficients[position] < 0.0) taken -= it.coefficients[position];
        taken *= end;
    }
    return it.coefficients[0] > taken * MARGIN;
}

/* Whether the first term of the derivative is larger than all others together. */
static bool one_way(struct polynomial it, double end)
{
    double others = 0.0;
    for (int position = it.count - 1; position > 1; position--)
        others = (others + position * fabs(it.coefficients[position])) * end;
    return fabs(it.coefficients[1]) > others * MARGIN;
}

/* The whole interval. */
static void bernstein(struct polynomial it, double end, struct part *whole)
{
    const int degree = it.count - 1;
    double power = 1.0, choices = 1.0;
    whole->low = 0.0;
    whole->high = end;
    for (int position = 0; position <= degree; position++) {
        whole->bounds[position] = it.coefficients[position] * power / choices;
        power *= end;
        choices = choices * (degree - position) / (position + 1);
    }
    for (int first = 1; first <= degree; first++)
        for (int position = degree; position >= first; position--)
            whole->bounds[position] += whole->bounds[position - 1];
}

/* The two halves, by de Casteljau's scheme; the right one takes the place of the whole. */
static void halve(struct part *whole, struct part *left, int count)
{
    const double middle = whole->low + 0.5 * (whole->high - whole->low);
    double *right = whole->bounds;
    left->low = whole->low;
    left->high = middle;
    whole->low = middle;
    left->bounds[0] = right[0];
    for (int last = count - 1; last > 0; last--) {
        for (int position = 0; position < last; position++)
            right[position] = 0.5 * (right[position] + right[position + 1]);
        left->bounds[count - last] = right[0];
    }
}

static double least(const double bounds[], int count)
{
    double found = bounds[0];
    for (int n = 1; n < count; n++)
        if (bounds[n] < found) found = bounds[n];
    return found;
}

static double largest(const double bounds[], int count)
{
    double found = bounds[0];
    for (int n = 1; n < count; n++)
        if (bounds[n] > found) found = bounds[n];
    return found;
}

/* Whether the Bernstein coefficients fall, so the polynomial does. */
static bool falls(const double bounds[], int count)
{
    for (int n = 0; n < count - 1; n++)
        if (bounds[n + 1] > bounds[n]) return false;
    return true;
}

/* Whether the Bernstein coefficients are convex, or concave for the sign -1. */
static bool bends(const double bounds[], int count, double sign)
{
    for (int n = 1; n < count - 1; n++) {
        const double bend = (bounds[n + 1] - bounds[n]) - (bounds[n] - bounds[n - 1]);
        if (sign * bend < 0.0) return false;
    }
    return true;
}

/* Where the derivative times `sign` falls through 0, between `low` and `high`. */
static double turn(struct polynomial it, double low, double high, double sign)
{
    double slopes[MOST_COEFFICIENTS];
    for (int power = 1; power < it.count; power++)
        slopes[power - 1] = sign * (power * it.coefficients[power]);
    const struct polynomial derivative = {slopes, it.count - 1};
    return falling_zero(polynomial_graph, &derivative, low, high);
}

/* Intervals are halved from left to right until the polynomial is above 0, falls, or is convex. */
bool polynomial_first_zero(struct polynomial it, double end, double *zero)
{
    struct part waiting[MOST_WAITING];
    int count = 1;
    if (stays_above(it, end)) return false;
    bernstein(it, end, &waiting[0]);
    while (count > 0) {
        struct part *part = &waiting[--count];
        const double *bounds = part->bounds;
        const double low = part->low, high = part->high;
        if (least(bounds, it.count) > 0.0) continue;
        const bool narrow = high - low <= NARROW * end || count + 1 == MOST_WAITING;
        if (narrow || falls(bounds, it.count)) {
            if (bounds[it.count - 1] <= 0.0) {
                *zero = falling_zero(polynomial_graph, &it, low, high);
                return true;
            }
        } else if (bends(bounds, it.count, 1.0)) {
            if (bounds[1] < bounds[0]) {
                const double lowest = turn(it, low, high, -1.0);
                if (polynomial_value(it, lowest) <= 0.0) {
                    *zero = falling_zero(polynomial_graph, &it, low, lowest);
                    return true;
                }
            }
        } else {
            halve(part, &waiting[count + 1], it.count);
            count += 2;
        }
    }
    return false;
}

/* Intervals are halved from left to right until the polynomial is monotone, concave, or nowhere
 * above the largest value found. */
double polynomial_highest(struct polynomial it, double end)
{
    struct part waiting[MOST_WAITING];
    int count = 1;
    const int last = it.count - 1;
    double best = it.coefficients[0];
    const double at_end = polynomial_value(it, end);
    if (at_end > best) best = at_end;
    if (one_way(it, end)) return best;
    bernstein(it, end, &waiting[0]);
    while (count > 0) {
        struct part *part = &waiting[--count];
        const double *bounds = part->bounds;
        const double low = part->low, high = part->high;
        /* The value at the right end; that at the left one was seen as the one before. */
        if (bounds[last] > best) best = bounds[last];
        if (largest(bounds, it.count) <= best) continue;
        /* Concave and higher inside than at its ends, so it turns. */
        if (bends(bounds, it.count, -1.0)) {
            const double top = polynomial_value(it, turn(it, low, high, 1.0));
            if (top > best) best = top;
        } else if (high - low > NARROW * end && count + 1 < MOST_WAITING) {
            halve(part, &waiting[count + 1], it.count);
            count += 2;
        }
    }
    return best;
}
