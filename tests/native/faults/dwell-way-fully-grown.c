/* After a slip the spring lacks the whole gap, as if a fresh stick held mu_s N.
 * replaces: coulomb_way
 * detected by: t_stick-course in dwell-growth
 */
#include "coulomb_slip.h"

double coulomb_way(const struct friction *it, const struct arc *ended);

double coulomb_way(const struct friction *it, const struct arc *ended)
{
    return coulomb_slip_way_to_break_away(ended, it->gap + it->dwell.rise);
}
