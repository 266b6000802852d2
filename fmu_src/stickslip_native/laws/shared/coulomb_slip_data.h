/* The data of a slip under constant kinetic friction, for the friction_law.h of laws that have one
 * as the member `coulomb` of their arcs: coulomb_slip.h. */
#ifndef STICKSLIP_COULOMB_SLIP_DATA_H
#define STICKSLIP_COULOMB_SLIP_DATA_H

#include "oscillator.h"

#include <stdbool.h>

struct coulomb_slip {
    struct oscillator oscillator;
    double v, kinetic, net;
    double z_dot, push, acceleration, reach, swing, fade, peak_time;
    bool from_rest;
};

#endif
