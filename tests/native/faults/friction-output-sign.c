/* In slip F_friction is the force on the way and not that on the mass.
 * replaces: coulomb_slip_state
 * detected by: slip-friction-against-motion in default
 */
#include "coulomb_slip.h"

struct motion true_coulomb_slip_state(const struct arc *arc, double tau);

struct motion coulomb_slip_state(const struct arc *arc, double tau)
{
    struct motion motion = true_coulomb_slip_state(arc, tau);
    motion.friction = -motion.friction;
    return motion;
}
