/* mu_k_used shows mu_k as it was set.
 * replaces: coulomb_output
 * detected by: mu_k-clamped in clamp
 */
#include "law.h"

double coulomb_output(const struct friction *it, enum reference reference);

double coulomb_output(const struct friction *it, enum reference reference)
{
    return reference == VR_mu_k_used ? it->settings.mu_k : 0.0;
}
