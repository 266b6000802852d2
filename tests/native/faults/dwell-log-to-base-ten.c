/* Static friction grows with the decimal logarithm.
 * replaces: log_growth
 * detected by: t_stick-course in dwell-logarithm
 */
#include <math.h>

double log_growth(double age, double t_0);

double log_growth(double age, double t_0)
{
    return log10(1.0 + age / t_0);
}
