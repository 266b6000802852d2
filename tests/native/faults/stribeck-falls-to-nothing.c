/* The friction of high speeds is left out, as if mu_k were 0.
 * law: stribeck
 * replaces: smooth_make
 * detected by: F_friction-course in speeds-stribeck
 */
#include "smooth.h"

void true_smooth_make(const struct settings *settings, double mu_k_used, double normal,
                      struct smooth *made);

void smooth_make(const struct settings *settings, double mu_k_used, double normal,
                 struct smooth *made)
{
    true_smooth_make(settings, mu_k_used, normal, made);
    made->rest = 0.0;
}
