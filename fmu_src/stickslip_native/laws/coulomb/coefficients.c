#include "coefficients.h"

/* The gap that a kinetic coefficient above the static one is clamped to. */
static const double CLAMP_GAP = 0.01;

bool is_clamped(double mu_s, double mu_k)
{
    return !(mu_k <= mu_s);
}

double kinetic_coefficient(double mu_s, double mu_k)
{
    if (!is_clamped(mu_s, mu_k)) return mu_k;
    const double clamped = mu_s - CLAMP_GAP;
    return clamped > 0.0 ? clamped : 0.0;
}
