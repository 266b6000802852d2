/* The integral of the step response is rounded to single precision.
 * replaces: oscillator_step_integral
 * detected by: x-course in default
 */
#include "oscillator.h"

double true_oscillator_step_integral(const struct oscillator *it, double tau,
                                     struct responses at);

double oscillator_step_integral(const struct oscillator *it, double tau, struct responses at)
{
    return (float)true_oscillator_step_integral(it, tau, at);
}
