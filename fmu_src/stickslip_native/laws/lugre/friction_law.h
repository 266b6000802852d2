/* LuGre friction: the data of its motion and of the law itself. */
#ifndef STICKSLIP_FRICTION_LAW_H
#define STICKSLIP_FRICTION_LAW_H

#include "extrapolation.h"

/* What the equations of mass, spring and bristles are made of: docs/theory.md (34). */
struct medium {
    double m, k, c, v, F_ext;
    double kinetic, gap, floor; /* friction at high speed, its rise to rest, its least [N] */
    double least;               /* force from which errors count [N] */
    double sigma_0, sigma_1, v_s, delta, v_d;
    double zeta_start;
};

#include "whole_data.h"

enum arc_tag { STICK, WHOLE, ARC_TAGS };

union arc_data {
    struct stick stick;
    struct whole whole;
};

struct lugre {
    struct medium medium;
    double mu_k_used;
};

union friction_data {
    struct lugre lugre;
};

#endif
