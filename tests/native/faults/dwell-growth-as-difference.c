/* What a young stick has gained is a difference of two forces.
 * replaces: dwell_growth
 * detected by: equal-bits in 300 sequences
 */
#include "dwell.h"

#include <math.h>

double true_dwell_growth(const struct dwell *it, double age);

double dwell_growth(const struct dwell *it, double age)
{
    if (!(it->rise > 0.0)) return true_dwell_growth(it, age);
    const struct dwell rest = {.strength = it->strength, .t_0 = it->t_0};
    return it->rise - it->rise * exp(-age / it->tau_s) + true_dwell_growth(&rest, age);
}
