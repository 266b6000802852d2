/* The logarithm of a ratio beyond the range of numbers is infinite.
 * replaces: log_growth
 * detected by: equal-bits in 3000 sequences
 */
#include <math.h>

double log_growth(double age, double t_0);

double log_growth(double age, double t_0)
{
    return log1p(age / t_0);
}
