/* The spring at break-away is computed from the time at rest and not from the forces.
 * replaces: stick_end
 * detected by: equal-bits in 50 sequences
 */
#include "sticking.h"

struct motion stick_state(const struct arc *arc, double tau);
struct motion stick_end(const struct arc *arc);

struct motion stick_end(const struct arc *arc)
{
    return stick_state(arc, arc->duration);
}
