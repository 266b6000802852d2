/* The functions of all arcs by their tag. */
#include "coulomb_slip.h"
#include "law.h"
#include "sticking.h"

const struct arc_functions *const ARCS[ARC_TAGS] = {
    [STICK] = &STICK_FUNCTIONS,
    [COULOMB_SLIP] = &COULOMB_SLIP_FUNCTIONS,
};
