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

int clamp_remark(double mu_s, double mu_k, struct remark *made)
{
    if (!is_clamped(mu_s, mu_k)) return 0;
    *made = (struct remark){"mu_k = %r is above mu_s = %r: "
                            "mu_k is clamped to max(mu_s - 0.01, 0), see mu_k_used",
                            {mu_k, mu_s}};
    return 1;
}
