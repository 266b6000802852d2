/* The net force at the end of a band is that at its beginning.
 * law: stribeck
 * replaces: band_slip_net_at_end
 * detected by: x_dot-course in speeds-curve
 */
#include "band.h"

double band_slip_net_at_end(const struct arc *ended, double growth)
{
    (void)growth;
    return ended->of.band.base;
}
