/* The coefficients of Coulomb's law: docs/theory.md (1). */
#ifndef STICKSLIP_COEFFICIENTS_H
#define STICKSLIP_COEFFICIENTS_H

#include "remark.h"

#include <stdbool.h>

/* The kinetic coefficient in use: mu_k, or the clamp where it exceeds mu_s. */
double kinetic_coefficient(double mu_s, double mu_k);

/* Whether the kinetic coefficient is clamped. */
bool is_clamped(double mu_s, double mu_k);

/* Make the remark that it is, with both values, and return 1; 0 if it is not. */
int clamp_remark(double mu_s, double mu_k, struct remark *made);

#endif
