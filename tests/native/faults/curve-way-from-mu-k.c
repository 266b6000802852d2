/* After a slip over a curve the way to break-away counts no gap.
 * law: stribeck
 * replaces: stribeck_way
 * detected by: t_stick-course in speeds-curve
 */
#include "law.h"

double true_stribeck_way(const struct friction *it, const struct arc *ended);
double stribeck_way(const struct friction *it, const struct arc *ended);

double stribeck_way(const struct friction *it, const struct arc *ended)
{
    struct friction other = *it;
    other.gap = 0.0;
    return true_stribeck_way(&other, ended);
}
