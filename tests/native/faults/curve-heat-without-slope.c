/* The heat in a band is that of the friction at its beginning.
 * law: stribeck
 * replaces: band_slip_heat
 * detected by: energy-balance in speeds-curve
 */
#include "band.h"

#include "coulomb_slip.h"

double band_slip_heat(const struct arc *arc, double tau, double displacement);

double band_slip_heat(const struct arc *arc, double tau, double displacement)
{
    return coulomb_slip_heat(arc, tau, displacement);
}
