/* Rates that are no doubles other than zero are taken.
 * replaces: oscillator_make
 * detected by: equal-bits in 400 sequences
 */
#include "oscillator.h"

enum refusal true_oscillator_make(struct oscillator *made, double k, double m, double c);

enum refusal oscillator_make(struct oscillator *made, double k, double m, double c)
{
    true_oscillator_make(made, k, m, c);
    return ACCEPTED;
}
