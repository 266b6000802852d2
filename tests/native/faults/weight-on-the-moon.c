/* The start value of g is another one than the interface has.
 * replaces: ROWS
 * detected by: break-away-force in default
 */
#include "table.h"

extern const struct row true_ROWS[VARIABLES];
struct row planted[VARIABLES] __asm__("ROWS");

__attribute__((constructor)) static void plant(void)
{
    for (int n = 0; n < VARIABLES; n++) planted[n] = true_ROWS[n];
    planted[VR_g].start = 9.80665;
}
