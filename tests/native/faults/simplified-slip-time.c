/* A slip lasts half a period of the free oscillation, pi/w, as for an infinitely slow pull.
 * replaces: coulomb_slip_find_end
 * detected by: t_slip-exact in default
 */
#include "law.h"

double true_coulomb_slip_find_end(struct arc *arc);
double coulomb_slip_find_end(struct arc *arc);

double coulomb_slip_find_end(struct arc *arc)
{
    true_coulomb_slip_find_end(arc);
    return 3.141592653589793 / arc->of.coulomb.oscillator.w;
}
