/* The over-damped motion decays at the fast rate only.
 * replaces: decaying
 * detected by: slip-propagates in overdamped
 */
#include "oscillator.h"

#include <math.h>

struct responses decaying(const struct oscillator *it, double tau);

struct responses decaying(const struct oscillator *it, double tau)
{
    const double fallen = -expm1(-it->fast * tau);
    return (struct responses){fallen, fallen / it->fast, 1.0 - fallen};
}
