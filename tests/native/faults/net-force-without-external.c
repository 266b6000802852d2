/* A slip from any state leaves out F_ext where there is damping.
 * replaces: coulomb_make_slip
 * detected by: any-sequence in 12 sequences
 */
#include "coulomb_slip.h"

enum refusal coulomb_make_slip(const struct friction *it, int mode, double z, double x_dot,
                               double net, struct arc *made);

enum refusal coulomb_make_slip(const struct friction *it, int mode, double z, double x_dot,
                               double net, struct arc *made)
{
    if (it->settings.c > 0.0) net -= it->settings.F_ext;
    coulomb_slip_make(&it->of.coulomb.oscillator, it->settings.v, z, x_dot, mode, net, it->kinetic,
                      made);
    return ACCEPTED;
}
