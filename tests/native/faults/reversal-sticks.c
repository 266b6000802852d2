/* A mass that comes to rest beyond the break-away force sticks there instead of reversing.
 * replaces: sticking_after
 * detected by: stick-within-break-away in reversals
 */
#include "sticking.h"

enum refusal true_sticking_after(const struct friction *it, const struct arc *ended, double z,
                                 struct arc *following);

enum refusal sticking_after(const struct friction *it, const struct arc *ended, double z,
                            struct arc *following)
{
    const enum refusal refused = true_sticking_after(it, ended, z, following);
    const struct start at_rest = {.z = z};
    if (ended->tag != STICK && following->mode != 0) sticking_arc(it, &at_rest, following);
    return refused;
}
