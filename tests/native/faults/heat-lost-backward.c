/* In a backward slip the heat falls: the displacement enters with its sign.
 * replaces: slip_heat
 * detected by: heat-never-falls in reversals
 */
#include "law.h"

double slip_heat(const struct arc *arc, double tau, double displacement);

double slip_heat(const struct arc *arc, double tau, double displacement)
{
    (void)tau;
    return arc->of.coulomb.kinetic * displacement;
}
