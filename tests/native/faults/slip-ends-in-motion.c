/* The velocity at the end of a slip is what rounding leaves of it.
 * replaces: coulomb_slip_end
 * detected by: equal-bits in 50 sequences
 */
#include "coulomb_slip.h"

struct motion coulomb_slip_end(const struct arc *arc)
{
    return COULOMB_SLIP_FUNCTIONS.state(arc, arc->duration);
}
