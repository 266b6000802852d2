/* Friction between two points of a curve is that of the lower one.
 * law: stribeck
 * replaces: curve_make
 * detected by: F_friction-course in speeds-curve
 */
#include "curve.h"

void true_curve_make(const struct settings *settings, double normal, struct curve *made);

void curve_make(const struct settings *settings, double normal, struct curve *made)
{
    true_curve_make(settings, normal, made);
    for (int n = 0; n < made->count; n++) {
        made->bands[n].slope = 0.0;
        made->bands[n].rise = made->bands[n].friction - settings->mu_1 * normal;
    }
}
