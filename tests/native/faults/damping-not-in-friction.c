/* F_friction is shown without its viscous part.
 * replaces: coulomb_slip_state
 * detected by: slip-friction in damped-cycle
 */
#include "coulomb_slip.h"

struct motion true_coulomb_slip_state(const struct arc *arc, double tau);

struct motion coulomb_slip_state(const struct arc *arc, double tau)
{
    struct motion motion = true_coulomb_slip_state(arc, tau);
    motion.friction = -(arc->mode * arc->of.coulomb.kinetic);
    return motion;
}
