/* Coulomb friction: the data of its slips and of the law itself. */
#ifndef STICKSLIP_FRICTION_LAW_H
#define STICKSLIP_FRICTION_LAW_H

#include "coulomb_slip_data.h"

/* Coulomb's law under given settings: coulomb.c. */
struct coulomb {
    struct oscillator oscillator;
    double mu_k_used; /* kinetic coefficient after the clamp */
};

enum arc_tag { STICK, COULOMB_SLIP, ARC_TAGS };

union arc_data {
    struct stick stick;
    struct coulomb_slip coulomb;
};

union friction_data {
    struct coulomb coulomb;
};

#endif
