/* A state of a slip has no force, so the slip that is remade from it computes it anew.
 * replaces: coulomb_slip_start
 * detected by: serialized-state-to-the-bit in default
 */
#include "coulomb_slip.h"

void true_coulomb_slip_start(const struct arc *arc, struct start *start);

void coulomb_slip_start(const struct arc *arc, struct start *start)
{
    true_coulomb_slip_start(arc, start);
    start->force = 0.0;
}
