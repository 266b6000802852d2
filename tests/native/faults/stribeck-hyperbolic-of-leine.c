/* The hyperbola falls three times as fast, as in the source of another model.
 * law: stribeck
 * replaces: smooth_make
 * detected by: F_friction-course in speeds-hyperbolic
 */
#include "smooth.h"

void true_smooth_make(const struct settings *settings, double mu_k_used, double normal,
                      struct smooth *made);

void smooth_make(const struct settings *settings, double mu_k_used, double normal,
                 struct smooth *made)
{
    true_smooth_make(settings, mu_k_used, normal, made);
    if (settings->shape == HYPERBOLIC) made->v_s /= 3.0;
}
