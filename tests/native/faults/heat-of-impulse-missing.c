/* The heat of damping leaves out the integral of the squared impulse response.
 * replaces: oscillator_squares
 * detected by: equal-bits in 100 sequences
 */
#include "oscillator.h"

void true_oscillator_squares(const struct oscillator *it, double tau, double *of_rest,
                             double *of_impulse);

void oscillator_squares(const struct oscillator *it, double tau, double *of_rest,
                        double *of_impulse)
{
    true_oscillator_squares(it, tau, of_rest, of_impulse);
    *of_impulse = 0.0;
}
