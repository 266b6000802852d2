/* The slow rate of decay is its limit k/c for heavy damping.
 * replaces: oscillator_make
 * detected by: slip-propagates in overdamped
 */
#include "oscillator.h"

enum refusal true_oscillator_make(struct oscillator *made, double k, double m, double c);

enum refusal oscillator_make(struct oscillator *made, double k, double m, double c)
{
    const enum refusal refused = true_oscillator_make(made, k, m, c);
    if (made->overdamped) made->slow = k / c;
    return refused;
}
