#include "dwell.h"

#include <math.h>

/* A step of Newton's method at least halves the way to the root, so this is never reached; it only
 * keeps values that are no numbers from looping for ever. */
enum { MOST_STEPS = 200 };

/* A line: its value at age 0, and its slope. */
struct line {
    double start, slope;
};

/* ln(1 + age/t_0), where the ratio is beyond the range of numbers too. */
static double log_growth(double age, double t_0)
{
    const double ratio = age / t_0;
    return ratio < HUGE_VAL ? log1p(ratio) : log(age) - log(t_0);
}

/* What is not below 0, though rounding may bring it there. */
static double not_below_zero(double value)
{
    return 0.0 > value ? 0.0 : value;
}

double dwell_growth(const struct dwell *it, double age)
{
    double grown = 0.0;
    if (it->rise > 0.0) grown = -it->rise * expm1(-age / it->tau_s);
    if (it->strength > 0.0) grown += it->strength * log_growth(age, it->t_0);
    return grown;
}

/* The tangent of the growth at an age. */
static struct line tangent(const struct dwell *it, double age)
{
    struct line line = {0.0, 0.0};
    if (it->rise > 0.0) {
        const double ratio = age / it->tau_s;
        const double left = exp(-ratio);
        const double gone = left > 0.0 ? ratio * left : 0.0;
        line.start = it->rise * not_below_zero(-expm1(-ratio) - gone);
        line.slope = it->rise * left / it->tau_s;
    }
    if (it->strength > 0.0) {
        const double whole = it->t_0 + age;
        line.start += it->strength * not_below_zero(log_growth(age, it->t_0) - age / whole);
        line.slope += it->strength / whole;
    }
    return line;
}

struct dwell dwell_extension(const struct dwell *it, double age, double k)
{
    const double left = it->rise > 0.0 ? it->rise * exp(-age / it->tau_s) : 0.0;
    return (struct dwell){left / k, it->tau_s, it->strength / k, it->t_0 + age};
}

double dwell_load_up(const struct dwell *it, double reach, double pull)
{
    if (reach == 0.0 && tangent(it, 0.0).slope <= pull) return 0.0;
    /* The tangent of the logarithm where its slope is below pull/2, and the other growth at its end.
     */
    const struct dwell rest = {.strength = it->strength, .t_0 = it->t_0};
    const double lasting = 2.0 * it->strength / pull;
    if (lasting == HUGE_VAL) return HUGE_VAL;
    struct line line = tangent(&rest, lasting);
    double root = (reach + it->rise + line.start) / (pull - line.slope);
    for (int n = 0; n < MOST_STEPS; n++) {
        line = tangent(it, root);
        if (!(line.slope < pull)) break;
        const double following = (reach + line.start) / (pull - line.slope);
        if (!(following < root)) break;
        root = following;
    }
    return root;
}
