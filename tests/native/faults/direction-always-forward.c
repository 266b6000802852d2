/* A load-up always breaks away forward, whichever way the pull goes.
 * replaces: sticking_after
 * detected by: mode-course in reversed-pull
 */
#include "sticking.h"

#include <math.h>

enum refusal true_sticking_after(const struct friction *it, const struct arc *ended, double z,
                                 struct arc *following);

enum refusal sticking_after(const struct friction *it, const struct arc *ended, double z,
                            struct arc *following)
{
    struct arc forward = *ended;
    if (forward.tag == STICK) forward.of.stick.v = fabs(forward.of.stick.v);
    return true_sticking_after(it, &forward, z, following);
}
