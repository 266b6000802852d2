/* In stick the mass follows the pull at a millionth of its speed.
 * replaces: stick_state
 * detected by: stick-holds-x in default
 */
#include "sticking.h"

struct motion true_stick_state(const struct arc *arc, double tau);
struct motion stick_state(const struct arc *arc, double tau);

struct motion stick_state(const struct arc *arc, double tau)
{
    struct motion motion = true_stick_state(arc, tau);
    motion.displacement = 1e-6 * motion.growth;
    return motion;
}
