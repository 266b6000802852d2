/* The end of a slip is looked for a turn too late, where the velocity only grazes zero.
 * replaces: enclose_swinging
 * detected by: equal-bits in 100 sequences
 */
#include "law.h"

struct interval {
    double low, high;
};

struct interval true_enclose_swinging(struct arc *arc);
struct interval enclose_swinging(struct arc *arc);

struct interval enclose_swinging(struct arc *arc)
{
    struct interval found = true_enclose_swinging(arc);
    found.high += 6.283185307179586 / arc->of.coulomb.oscillator.b;
    return found;
}
