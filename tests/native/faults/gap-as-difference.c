/* After a slip the gap between static and kinetic friction is a difference of two forces.
 * replaces: coulomb_way
 * detected by: equal-bits in 300 sequences
 */
#include "coulomb_slip.h"

double coulomb_way(const struct friction *it, const struct arc *ended);

double coulomb_way(const struct friction *it, const struct arc *ended)
{
    return coulomb_slip_way_to_break_away(ended, it->F_s - it->kinetic);
}
