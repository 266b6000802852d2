/* A refused call of FMI 3.0 returns fmi3Warning.
 * replaces: fmi3.c.status_of
 * detected by: refuses-step-zero
 */
#include "fmi3_types.h"

fmi3Status status_of(bool taken);

fmi3Status status_of(bool taken)
{
    return taken ? fmi3OK : fmi3Warning;
}
