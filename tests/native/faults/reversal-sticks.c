/* A mass that comes to rest beyond the break-away force sticks there instead of reversing.
 * replaces: sticking_after
 * detected by: stick-within-break-away in reversals
 */
#include "sticking.h"

void true_sticking_after(const struct friction *it, const struct arc *ended, double z,
                         struct arc *following);

void sticking_after(const struct friction *it, const struct arc *ended, double z,
                    struct arc *following)
{
    struct friction firm = *it;
    if (ended->tag != STICK) firm.F_s = 1e300;
    true_sticking_after(&firm, ended, z, following);
    if (following->tag == STICK) true_sticking_after(it, ended, 0.0, following);
}
