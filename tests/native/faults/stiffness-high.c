/* The stiffness in the oscillator is 0.1 % too high, as from a catalogue in other units.
 * replaces: oscillator_make
 * detected by: t_slip-exact in default
 */
#include "oscillator.h"

enum refusal true_oscillator_make(struct oscillator *made, double k, double m, double c);

enum refusal oscillator_make(struct oscillator *made, double k, double m, double c)
{
    return true_oscillator_make(made, 1.001 * k, m, c);
}
