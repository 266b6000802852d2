/* f is infinite as long as there is no period.
 * replaces: meter_frequency
 * detected by: finite in default
 */
#include "meter.h"

double meter_frequency(const struct meter *meter)
{
    return 1.0 / meter->T;
}
