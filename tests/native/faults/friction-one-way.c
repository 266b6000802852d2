/* Kinetic friction of a slip from any state has the sign of a forward slip.
 * replaces: slip_from
 * detected by: slip-propagates in moving-back
 */
#include "sticking.h"

enum refusal slip_from(const struct friction *it, int mode, double z, double x_dot,
                       struct arc *made);

enum refusal slip_from(const struct friction *it, int mode, double z, double x_dot,
                       struct arc *made)
{
    const double net = it->settings.k * z + it->settings.F_ext - it->kinetic;
    return LAW.slip(it, mode, z, x_dot, net, made);
}
