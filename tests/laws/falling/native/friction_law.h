/* Falling kinetic friction: the data of its slips and of the law. */
#ifndef STICKSLIP_FRICTION_LAW_H
#define STICKSLIP_FRICTION_LAW_H

#include "oscillator.h"

#include <stdbool.h>

/* As of Coulomb's slip, whose functions are used. */
struct coulomb_slip {
    struct oscillator oscillator;
    double v, kinetic, net;
    double z_dot, push, acceleration, reach, swing, fade, peak_time;
    bool from_rest;
};

/* A slip up to its end, or to the end of the law at the speed `limit` [m/s]. */
struct falling_slip {
    struct coulomb_slip coulomb;
    double limit;
    bool passed_limit;
};

struct falling {
    struct oscillator oscillator;
    double mu_k_used;
    double limit; /* mu_k/slope, where the friction is 0 [m/s] */
};

enum arc_tag { STICK, COULOMB_SLIP, FALLING_SLIP, ARC_TAGS };

union arc_data {
    struct stick stick;
    struct coulomb_slip coulomb;
    struct falling_slip falling;
};

union friction_data {
    struct falling falling;
};

#endif
