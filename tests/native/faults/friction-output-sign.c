/* In slip F_friction is the force on the way and not that on the mass.
 * replaces: slip_state
 * detected by: slip-friction-against-motion in default
 */
#include "law.h"

struct motion true_slip_state(const struct arc *arc, double tau);
struct motion slip_state(const struct arc *arc, double tau);

struct motion slip_state(const struct arc *arc, double tau)
{
    struct motion motion = true_slip_state(arc, tau);
    motion.friction = -motion.friction;
    return motion;
}
