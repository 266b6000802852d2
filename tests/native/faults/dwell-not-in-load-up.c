/* A load-up ends at what the stick held when it began.
 * replaces: dwell_load_up
 * detected by: t_stick-course in dwell-growth
 */
#include "dwell.h"

double dwell_load_up(const struct dwell *it, double reach, double pull)
{
    (void)it;
    return reach / pull;
}
