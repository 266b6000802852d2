/* The formula for two rates of decay is used where they are equal, so it divides by zero.
 * replaces: decaying
 * detected by: runs-to-the-end in critically-damped
 */
#include "oscillator.h"

#include <math.h>

struct responses decaying(const struct oscillator *it, double tau);

struct responses decaying(const struct oscillator *it, double tau)
{
    const double slow = exp(-it->slow * tau), fast = exp(-it->fast * tau), apart = 2.0 * it->b;
    const double impulse = (slow - fast) / apart;
    return (struct responses){1.0 - (it->fast * slow - it->slow * fast) / apart, impulse,
                              fast - it->slow * impulse};
}
