/* Rate-and-state friction: the data of its motion and of the law itself. */
#ifndef STICKSLIP_FRICTION_LAW_H
#define STICKSLIP_FRICTION_LAW_H

#include "extrapolation.h"

enum { AGING = 1, SLIP };
enum { INERTIA = 1, RADIATION_DAMPING };

/* What the equations of mass, spring and contacts are made of: docs/theory.md (35). */
struct medium {
    double m, k, c, v, F_ext, normal, least;
    double mu_0, a, b, D_c, V_0, V_ref, phi_start;
    int evolution, inertia;
};

#include "whole_data.h"

enum arc_tag { STICK, WHOLE, ARC_TAGS };

union arc_data {
    struct stick stick;
    struct whole whole;
};

struct rate_state {
    struct medium medium;
    double load_effect; /* by how much a change of the normal force has changed the state */
};

union friction_data {
    struct rate_state rate_state;
};

#endif
