/* Load and external force are exchanged in the record of settings.
 * replaces: ROWS
 * detected by: x-course in lightened
 */
#include "table.h"

extern const struct row true_ROWS[VARIABLES];
struct row planted[VARIABLES] __asm__("ROWS");

__attribute__((constructor)) static void plant(void)
{
    for (int n = 0; n < VARIABLES; n++) planted[n] = true_ROWS[n];
    planted[VR_load].offset = true_ROWS[VR_F_ext].offset;
    planted[VR_F_ext].offset = true_ROWS[VR_load].offset;
}
