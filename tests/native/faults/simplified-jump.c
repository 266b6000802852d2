/* The jump is the relief of the spring: the travel of the pulled end in the slip is left out.
 * replaces: coulomb_slip_end
 * detected by: jump-is-v-T in default
 */
#include "coulomb_slip.h"

struct motion true_coulomb_slip_end(const struct arc *arc);

struct motion coulomb_slip_end(const struct arc *arc)
{
    struct motion end = true_coulomb_slip_end(arc);
    end.displacement = -end.growth;
    return end;
}
