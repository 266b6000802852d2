/* The extreme velocity of a slip is asked of the functions of a stick.
 * replaces: ARCS
 * detected by: x_dot_peak-exact in default
 */
#include "coulomb_slip.h"
#include "sticking.h"

static struct arc_functions mixed;
const struct arc_functions *planted[ARC_TAGS] __asm__("ARCS") = {&STICK_FUNCTIONS, &mixed};

__attribute__((constructor)) static void plant(void)
{
    mixed = COULOMB_SLIP_FUNCTIONS;
    mixed.extreme_velocity = STICK_FUNCTIONS.extreme_velocity;
}
