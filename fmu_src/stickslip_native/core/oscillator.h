/* The mass on its spring, with any damping, also a negative one. docs/theory.md (3). */
#ifndef STICKSLIP_OSCILLATOR_H
#define STICKSLIP_OSCILLATOR_H

#include "refusal.h"

#include <stdbool.h>

/* Rates and responses of m y'' + c y' + k y = 0.
 *
 * The impulse response K starts at 0 with slope 1, the step response is G = w^2 times its integral;
 * every motion is a sum of the two:
 *
 *     E = exp(-a tau),   K = E sin(b tau)/b,   G = 1 - E cos(b tau) - a K
 *
 * for abs(a) < w, with the hyperbolic functions beyond. */
struct oscillator {
    double k, m, c;    /* stiffness [N/m], mass [kg], viscous damping [N.s/m] */
    double w, w2;      /* undamped angular frequency [rad/s] and its square */
    double a;          /* rate of decay c/(2m) [1/s] */
    double b;          /* damped angular frequency, or half the distance of the rates [1/s] */
    double fast, slow; /* the rates of decay a + b and a - b where abs(a) >= w, else a and a */
    double quickest;   /* the largest of all rates [1/s] */
    double beginning;  /* up to here the power series is summed [s] */
    bool overdamped;   /* abs(a) >= w */
    bool far_apart;    /* the two rates are taken one by one */
};

/* G [1], K [s] and the slope of K [1] at one time. */
struct responses {
    double step, impulse, slope;
};

/* Make an oscillator; RATES_OUT_OF_RANGE if a rate is no double other than zero. */
enum refusal oscillator_make(struct oscillator *made, double k, double m, double c);

/* The responses at tau [s]. */
struct responses oscillator_responses(const struct oscillator *it, double tau);

/* H, the integral of G from 0 to tau [s], where G and K are given. The integral of K is G/w^2. */
double oscillator_step_integral(const struct oscillator *it, double tau, struct responses at);

/* The integrals of (1 - G)^2 [s] and K^2 [s^3] up to tau: docs/theory.md (15). For a other than 0.
 * Both lose digits where G is small all the way, for a short tau. */
void oscillator_squares(const struct oscillator *it, double tau, double *of_rest,
                        double *of_impulse);

#endif
