/* The peak velocity is taken pi/(2 w) after break-away.
 * replaces: enclose_swinging
 * detected by: x_dot_peak-exact in default
 */
#include "law.h"

struct interval {
    double low, high;
};

struct interval true_enclose_swinging(struct arc *arc);
struct interval enclose_swinging(struct arc *arc);

struct interval enclose_swinging(struct arc *arc)
{
    const struct interval found = true_enclose_swinging(arc);
    arc->of.coulomb.peak_time = 1.5707963267948966 / arc->of.coulomb.oscillator.w;
    return found;
}
