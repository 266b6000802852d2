/* The mass may be changed while the simulation runs.
 * replaces: ROWS
 * detected by: refuses-change-of-mass
 */
#include "table.h"

extern const struct row true_ROWS[VARIABLES];
struct row planted[VARIABLES] __asm__("ROWS");

__attribute__((constructor)) static void plant(void)
{
    for (int n = 0; n < VARIABLES; n++) planted[n] = true_ROWS[n];
    planted[VR_m].fixed = false;
}
