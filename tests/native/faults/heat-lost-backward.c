/* In a backward slip the heat falls: the displacement enters with its sign.
 * replaces: coulomb_slip_heat
 * detected by: heat-never-falls in reversals
 */
#include "coulomb_slip.h"

double coulomb_slip_heat(const struct arc *arc, double tau, double displacement)
{
    (void)tau;
    return arc->of.coulomb.kinetic * displacement;
}
