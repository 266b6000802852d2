/* The heat of damping is left out.
 * replaces: squared_velocity
 * detected by: energy-balance in damped-cycle
 */
#include "coulomb_slip.h"

double squared_velocity(const struct arc *arc, double tau, double displacement)
{
    (void)arc, (void)tau, (void)displacement;
    return 0.0;
}
