/* The step response without damping is 1 - cos(w tau), which cancels near a whole turn.
 * replaces: undamped
 * detected by: equal-bits in 50 sequences
 */
#include "oscillator.h"

#include <math.h>

struct responses undamped(const struct oscillator *it, double tau);

struct responses undamped(const struct oscillator *it, double tau)
{
    const double cosine = cos(it->w * tau);
    return (struct responses){1.0 - cosine, sin(it->w * tau) / it->w, cosine};
}
