/* The last successful time is that of the start.
 * replaces: fmi2GetRealStatus
 * detected by: call-sequences in 1000 sequences
 */
#include "fmi2_types.h"
#include "instance.h"

fmi2Status fmi2GetRealStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Real *value);

fmi2Status fmi2GetRealStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Real *value)
{
    if (c == NULL) return fmi2Error;
    if (kind != fmi2LastSuccessfulTime) return fmi2Discard;
    *value = 0.0;
    return fmi2OK;
}
