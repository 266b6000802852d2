/* A slip lasts half a period of the free oscillation, pi/w, as for an infinitely slow pull.
 * replaces: find_end
 * detected by: t_slip-exact in default
 */
#include "law.h"

double true_find_end(struct arc *arc);
double find_end(struct arc *arc);

double find_end(struct arc *arc)
{
    true_find_end(arc);
    return 3.141592653589793 / arc->of.coulomb.oscillator.w;
}
