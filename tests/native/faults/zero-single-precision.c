/* The end of a slip is found in single precision, as on a controller.
 * replaces: falling_zero
 * detected by: t_slip-course in reversals-damped
 */
#include "numerics.h"

double true_falling_zero(graph *function, const void *context, double low, double high);

double falling_zero(graph *function, const void *context, double low, double high)
{
    return (float)true_falling_zero(function, context, low, high);
}
