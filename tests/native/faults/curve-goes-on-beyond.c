/* Beyond the last point the last line goes on.
 * law: stribeck
 * replaces: curve_make
 * detected by: F_friction-course in speeds-curve
 */
#include "curve.h"

void true_curve_make(const struct settings *settings, double normal, struct curve *made);

void curve_make(const struct settings *settings, double normal, struct curve *made)
{
    true_curve_make(settings, normal, made);
    struct band *last = &made->bands[made->count - 1];
    if (made->count > 1) {
        last->rise = last[-1].rise;
        last->slope = last[-1].slope;
    }
}
