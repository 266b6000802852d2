#include "oscillator.h"

#include "numerics.h"

#include <float.h>
#include <math.h>

/* Above this damping ratio the two rates of decay are far enough apart to be taken one by one. */
static const double FAR_APART = 2.0;

/* Below this multiple of the shortest time the step response is summed as a power series: its
 * closed form is a difference of terms that are larger by the inverse of that multiple. */
static const double BEGINNING = 0.25;
static const double NEGLIGIBLE = 8.673617379884035e-19; /* 2^-60 */

/* Up to BEGINNING a term is below a quarter of the one before, so about 20 are needed. */
enum { MOST_TERMS = 32, FIRST_POWER = 2 };

/* The terms of the power series of G up to BEGINNING; each follows from the equation of motion. */
struct series {
    int count;
    double term[MOST_TERMS]; /* the first one belongs to tau^2 */
};

static struct series series_of(const struct oscillator *it, double tau)
{
    const double damping = 2.0 * it->a * tau;
    const double spring = it->w2 * tau * tau;
    double before = 0.0, term = 0.5 * spring;
    const double negligible = NEGLIGIBLE * term;
    struct series made;
    made.count = 0;
    while (made.count < MOST_TERMS && fabs(term) + spring * fabs(before) > negligible) {
        const int power = FIRST_POWER + made.count;
        made.term[made.count++] = term;
        const double following =
            -(damping * power * term + spring * before) / (power * (power + 1));
        before = term;
        term = following;
    }
    return made;
}

enum refusal oscillator_make(struct oscillator *made, double k, double m, double c)
{
    struct oscillator it = {.k = k, .m = m, .c = c};
    it.w2 = k / m;
    it.w = sqrt(it.w2);
    it.a = it.fast = it.slow = 0.5 * c / m;
    it.b = sqrt(fabs((it.w - it.a) * (it.w + it.a)));
    it.overdamped = fabs(it.a) >= it.w;
    it.far_apart = fabs(it.a) > FAR_APART * it.w;
    if (it.overdamped) {
        /* The larger of the two has all its digits as a sum; their product is w^2. */
        if (it.a > 0.0) {
            it.fast = it.a + it.b;
            it.slow = it.w2 / it.fast;
        } else {
            it.slow = it.a - it.b;
            it.fast = it.slow < 0.0 ? it.w2 / it.slow : 0.0;
        }
    }
    it.quickest = it.w;
    if (it.fast > it.quickest) it.quickest = it.fast;
    if (-it.slow > it.quickest) it.quickest = -it.slow;
    const bool still = it.slow == 0.0 || it.fast == 0.0;
    if (!(it.w2 > 0.0 && it.quickest <= DBL_MAX && (c == 0.0 || !still)))
        return RATES_OUT_OF_RANGE;
    it.beginning = BEGINNING / it.quickest;
    *made = it;
    return ACCEPTED;
}

static struct responses from_series(const struct oscillator *it, double tau)
{
    const struct series series = series_of(it, tau);
    double step = 0.0, slope = 0.0;
    for (int n = 0; n < series.count; n++) {
        step += series.term[n];
        slope += (FIRST_POWER + n) * series.term[n];
    }
    const double spring = it->w2 * tau * tau;
    const double impulse = spring > 0.0 ? slope / spring * tau : tau;
    return (struct responses){step, impulse, 1.0 - step - 2.0 * it->a * impulse};
}

/* For a = 0. Here and in `swinging` the cosine is taken from the half angle: near a whole turn G is
 * small, and there a slip that grazes standstill is decided. */
static struct responses undamped(const struct oscillator *it, double tau)
{
    const double half = 0.5 * it->w * tau;
    const double sine = sin(half);
    const double step = 2.0 * sine * sine;
    return (struct responses){step, 2.0 * sine * cos(half) / it->w, 1.0 - step};
}

/* For 0 < abs(a) < w. */
static struct responses swinging(const struct oscillator *it, double tau)
{
    const double half = 0.5 * it->b * tau;
    const double sine = sin(half);
    const double decay = exp(-it->a * tau);
    const double twice = 2.0 * decay * sine;
    const double impulse = twice * cos(half) / it->b;
    const double along = it->a * impulse;
    const double fallen = twice * sine;
    return (struct responses){fallen - expm1(-it->a * tau) - along, impulse,
                              decay - fallen - along};
}

/* For abs(a) >= w. */
static struct responses decaying(const struct oscillator *it, double tau)
{
    const double slow = it->slow, fast = it->fast, apart = 2.0 * it->b;
    const double rise = apart > 0.0 ? -expm1(-apart * tau) / apart : tau;
    const double impulse = exp(-slow * tau) * rise;
    const double slope = exp(-fast * tau) - slow * impulse;
    const double slowly = expm1(-slow * tau), quickly = expm1(-fast * tau);
    if (it->far_apart)
        return (struct responses){(slow * quickly - fast * slowly) / apart, impulse, slope};
    return (struct responses){-0.5 * (slowly + quickly) - it->a * impulse, impulse, slope};
}

struct responses oscillator_responses(const struct oscillator *it, double tau)
{
    if (tau < it->beginning) return from_series(it, tau);
    if (it->overdamped) return decaying(it, tau);
    return it->c == 0.0 ? undamped(it, tau) : swinging(it, tau);
}

/* The integral of 1 - exp(-rate t) from 0 to tau. */
static double lag(double rate, double tau)
{
    const double x = rate * tau;
    if (fabs(x) > BEGINNING) return tau + expm1(-x) / rate;
    double total = 0.0, term = 0.5 * x;
    int power = 2;
    while (fabs(term) > NEGLIGIBLE * fabs(total)) {
        total += term;
        power += 1;
        term *= -x / power;
    }
    return tau * total;
}

double oscillator_step_integral(const struct oscillator *it, double tau, struct responses at)
{
    if (tau < it->beginning) {
        struct series series = series_of(it, tau);
        for (int n = 0; n < series.count; n++) series.term[n] /= FIRST_POWER + n + 1;
        return tau * exact_sum(series.term, series.count);
    }
    if (it->far_apart) {
        const double slow = lag(it->slow, tau), fast = lag(it->fast, tau);
        return (it->fast * slow - it->slow * fast) / (2.0 * it->b);
    }
    return tau - at.impulse - 2.0 * it->a / it->w2 * at.step;
}

void oscillator_squares(const struct oscillator *it, double tau, double *of_rest,
                        double *of_impulse)
{
    const double a = it->a, w2 = it->w2;
    const struct responses at = oscillator_responses(it, tau);
    const double rest = 1.0 - at.step;
    const double decay = -expm1(-2.0 * a * tau) / (2.0 * a);
    *of_impulse = (decay - at.impulse * rest) / (2.0 * w2);
    *of_rest = at.impulse * rest + a / w2 * at.step * (1.0 + rest) + w2 * *of_impulse;
}
