/* A load that lifts the mass off gives a normal force of zero instead of a refusal.
 * replaces: normal_force
 * detected by: refuses-load-that-lifts
 */
#include "law.h"

#include <math.h>

enum refusal normal_force(const struct settings *settings, double *normal)
{
    *normal = fmax(settings->m * settings->g + settings->load, 0.0);
    return ACCEPTED;
}
