/* The rest test after a change compares with kinetic friction.
 * replaces: sticking_hold
 * detected by: onset-beyond-break-away in load-pulses
 */
#include "sticking.h"

double sticking_hold(const struct friction *it, double age)
{
    (void)age;
    return it->kinetic;
}
