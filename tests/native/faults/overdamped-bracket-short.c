/* The end of an over-damped slip is looked for in one time constant.
 * replaces: enclose_decaying
 * detected by: equal-bits in 100 sequences
 */
#include "law.h"

#include <math.h>

struct interval {
    double low, high;
};

struct interval true_enclose_decaying(struct arc *arc);
struct interval enclose_decaying(struct arc *arc);

struct interval enclose_decaying(struct arc *arc)
{
    struct interval found = true_enclose_decaying(arc);
    if (found.high < HUGE_VAL) found.high = found.low + 1.0 / arc->of.coulomb.oscillator.w;
    return found;
}
