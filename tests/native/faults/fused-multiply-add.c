/* The step response below critical damping is contracted to fused multiply-adds.
 * replaces: swinging
 * detected by: equal-bits in 50 sequences
 */
#include "oscillator.h"

#include <math.h>

struct responses true_swinging(const struct oscillator *it, double tau);
struct responses swinging(const struct oscillator *it, double tau);

struct responses swinging(const struct oscillator *it, double tau)
{
    struct responses at = true_swinging(it, tau);
    const double sine = sin(0.5 * it->b * tau), decay = exp(-it->a * tau);
    const double fallen = 2.0 * decay * sine * sine;
    at.slope = fma(-it->a, at.impulse, decay - fallen);
    return at;
}
