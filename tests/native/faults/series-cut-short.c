/* The power series of the step response has three terms.
 * replaces: series_of
 * detected by: equal-bits in 200 sequences
 */
#include "oscillator.h"

struct series {
    int count;
    double term[32];
};

struct series true_series_of(const struct oscillator *it, double tau);
struct series series_of(const struct oscillator *it, double tau);

struct series series_of(const struct oscillator *it, double tau)
{
    struct series made = true_series_of(it, tau);
    if (made.count > 3) made.count = 3;
    return made;
}
