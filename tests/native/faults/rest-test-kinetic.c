/* The rest test after a change compares with kinetic friction.
 * replaces: sticking_hold
 * detected by: mode-course in load-drops-at-rest
 */
#include "sticking.h"

double sticking_hold(const struct friction *it, double age)
{
    (void)age;
    return it->kinetic;
}
