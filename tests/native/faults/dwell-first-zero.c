/* A stick that begins with just the force that it holds breaks away at once.
 * replaces: dwell_load_up
 * detected by: t_event-course in dwell-held-by-growth
 */
#include "dwell.h"

double true_dwell_load_up(const struct dwell *it, double reach, double pull);

double dwell_load_up(const struct dwell *it, double reach, double pull)
{
    return reach > 0.0 ? true_dwell_load_up(it, reach, pull) : 0.0;
}
