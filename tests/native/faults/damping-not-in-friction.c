/* F_friction is shown without its viscous part.
 * replaces: slip_state
 * detected by: slip-friction in damped-cycle
 */
#include "law.h"

struct motion true_slip_state(const struct arc *arc, double tau);
struct motion slip_state(const struct arc *arc, double tau);

struct motion slip_state(const struct arc *arc, double tau)
{
    struct motion motion = true_slip_state(arc, tau);
    motion.friction = -(arc->mode * arc->of.coulomb.kinetic);
    return motion;
}
