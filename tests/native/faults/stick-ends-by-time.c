/* The spring at break-away is computed from the time at rest and not from the forces.
 * replaces: stick_end
 * detected by: sticks-at-break-away
 */
#include "sticking.h"

struct motion stick_end(const struct arc *arc);

struct motion stick_end(const struct arc *arc)
{
    return STICK_FUNCTIONS.state(arc, arc->duration);
}
