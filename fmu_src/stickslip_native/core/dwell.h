/* Growth of the break-away force with the age t of a stick: docs/theory.md (19).
 *
 * F_s(t) = F_s(0) + rise (1 - exp(-t/tau_s)) + strength ln(1 + t/t_0)
 *
 * With tau_s = 0 the first growth is over at once and part of F_s(0). */
#ifndef STICKSLIP_DWELL_H
#define STICKSLIP_DWELL_H

/* The growth: concave, 0 at age 0. None where rise and strength are 0. */
struct dwell {
    double rise;     /* what is still gained with the time constant tau_s [N]; 0 for tau_s = 0 */
    double tau_s;    /* [s] */
    double strength; /* what is gained with the logarithm of the age [N] */
    double t_0;      /* age from which on the logarithm counts [s] */
};

/* What a stick of this age has gained since it began. */
double dwell_growth(const struct dwell *it, double age);

/* The growth from this age on, of a spring of stiffness k [m for N]. */
struct dwell dwell_extension(const struct dwell *it, double age, double k);

/* How long a spring is loaded up to break-away [s].
 *
 * What lacks is reach + growth(t) - pull t: concave, and not below 0 at the start. It has one root
 * beyond which it stays below 0. A tangent is nowhere below the function, so where it falls its own
 * root is beyond that one: Newton's method falls to the root from there.
 *
 * `reach` is what the extension lacks at the start of what breaks away then, at least 0 [m]; `pull`
 * the speed of the pulled end, above 0 [m/s]; `it` the growth of the extension that breaks away [m],
 * from the start on. */
double dwell_load_up(const struct dwell *it, double reach, double pull);

#endif
