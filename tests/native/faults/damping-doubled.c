/* The rate of decay is c/m instead of c/(2 m).
 * replaces: oscillator_make
 * detected by: slip-propagates in damped-cycle
 */
#include "oscillator.h"

enum refusal true_oscillator_make(struct oscillator *made, double k, double m, double c);

enum refusal oscillator_make(struct oscillator *made, double k, double m, double c)
{
    const enum refusal refused = true_oscillator_make(made, k, m, 2.0 * c);
    made->c = c;
    return refused;
}
