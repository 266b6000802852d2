/* What a stick lacks of break-away after a slip is a difference of two large forces.
 * replaces: coulomb_slip_way_to_break_away
 * detected by: equal-bits in 50 sequences
 */
#include "coulomb_slip.h"

double true_coulomb_slip_way_to_break_away(const struct arc *slip, double gap);

double coulomb_slip_way_to_break_away(const struct arc *slip, double gap)
{
    const double way = true_coulomb_slip_way_to_break_away(slip, gap);
    const double large = 1e6 * slip->of.coulomb.kinetic;
    return (large + way) - large;
}
