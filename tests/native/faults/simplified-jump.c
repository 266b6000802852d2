/* The jump is the relief of the spring: the travel of the pulled end in the slip is left out.
 * replaces: slip_end
 * detected by: jump-is-v-T in default
 */
#include "law.h"

struct motion true_slip_end(const struct arc *arc);
struct motion slip_end(const struct arc *arc);

struct motion slip_end(const struct arc *arc)
{
    struct motion end = true_slip_end(arc);
    end.displacement = -end.growth;
    return end;
}
