/* A refused call returns fmi2Discard.
 * replaces: status_of
 * detected by: call-sequences in 300 sequences
 */
#include "fmi2_types.h"

fmi2Status status_of(int taken);

fmi2Status status_of(int taken)
{
    return taken ? fmi2OK : fmi2Discard;
}
