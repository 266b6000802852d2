#include "numerics.h"

#include <math.h>

/* Newton's step doubles the digits and a halving adds one, so 200 is never reached; it only keeps a
 * function that returns nonsense from looping for ever. */
enum { MOST_STEPS = 200 };

/* Below this relative step the next iterate would differ by rounding alone: 2^-52. */
static const double SETTLED = 2.220446049250313e-16;

/* Partial sums of doubles that do not overlap: 2098 bits in parts of 53 are fewer. */
enum { MOST_PARTIALS = 64 };

/* Abscissae above zero and weights on (-1, 1): Abramowitz and Stegun, table 25.4. */
enum { PAIRS = 8 };
static const struct {
    double abscissa, weight;
} POINTS[PAIRS] = {
    {0.09501250983763744, 0.1894506104550685},  {0.2816035507792589, 0.18260341504492358},
    {0.45801677765722737, 0.16915651939500254}, {0.6178762444026438, 0.14959598881657674},
    {0.755404408355003, 0.12462897125553388},   {0.8656312023878318, 0.09515851168249279},
    {0.9445750230732326, 0.062253523938647894}, {0.9894009349916499, 0.027152459411754096},
};

struct sum sum_with(struct sum total, double term)
{
    const double start = total.high;
    const double high = start + term;
    const double shadow = high - start;
    const double low = total.low + ((start - (high - shadow)) + (term - shadow));
    const double rounded = high + low;
    return (struct sum){rounded, low - (rounded - high)};
}

bool is_sum(struct sum parts)
{
    return parts.high + parts.low == parts.high;
}

double exact_sum(const double terms[], int count)
{
    double partials[MOST_PARTIALS];
    int kept = 0;
    for (int n = 0; n < count; n++) {
        double x = terms[n];
        int left = 0;
        for (int i = 0; i < kept; i++) {
            double y = partials[i];
            if (fabs(x) < fabs(y)) {
                const double swapped = x;
                x = y;
                y = swapped;
            }
            const double high = x + y;
            const double low = y - (high - x);
            if (low != 0.0) partials[left++] = low;
            x = high;
        }
        partials[left] = x;
        kept = left + 1;
    }
    if (kept == 0) return 0.0;
    double high = partials[--kept], low = 0.0;
    while (kept > 0) {
        const double x = high, y = partials[--kept];
        high = x + y;
        low = y - (high - x);
        if (low != 0.0) break;
    }
    /* What is left decides a tie: round half to even on the whole sum. */
    if (kept > 0 && ((low < 0.0 && partials[kept - 1] < 0.0) ||
                     (low > 0.0 && partials[kept - 1] > 0.0))) {
        const double doubled = 2.0 * low;
        const double moved = high + doubled;
        if (doubled == moved - high) high = moved;
    }
    return high;
}

double falling_zero(graph *function, const void *context, double low, double high)
{
    double guess = low + 0.5 * (high - low);
    double step = high - low, step_before = step;
    for (int n = 0; n < MOST_STEPS; n++) {
        double value, slope;
        function(context, guess, &value, &slope);
        if (value > 0.0)
            low = guess;
        else if (value < 0.0)
            high = guess;
        else
            return guess;
        const double halving = low + 0.5 * (high - low);
        double next = slope < 0.0 ? guess - value / slope : halving;
        if (!(low < next && next < high) || fabs(2.0 * value) > fabs(step_before * slope))
            next = halving;
        step_before = step;
        step = next - guess;
        guess = next;
        if (fabs(step) <= SETTLED * guess) break;
    }
    return guess;
}

double integral(graph *function, const void *context, double start, double end)
{
    const double middle = 0.5 * (start + end);
    const double half = 0.5 * (end - start);
    double total = 0.0;
    for (int n = 0; n < PAIRS; n++) {
        const double reach = half * POINTS[n].abscissa;
        double before, after, slope;
        function(context, middle - reach, &before, &slope);
        function(context, middle + reach, &after, &slope);
        total += POINTS[n].weight * (before + after);
    }
    return half * total;
}
