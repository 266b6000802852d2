/* The load-up ends at the point from which Newton's method starts.
 * replaces: dwell_load_up
 * detected by: t_stick-course in dwell-growth
 */
#include "dwell.h"

double true_dwell_load_up(const struct dwell *it, double reach, double pull);

double dwell_load_up(const struct dwell *it, double reach, double pull)
{
    const double root = true_dwell_load_up(it, reach, pull);
    const double guess = (reach + it->rise) / pull;
    return guess > root ? guess : root;
}
