/* Numbers of FMI 3.0 go through single precision.
 * replaces: fmi3GetFloat64
 * detected by: x-course in default
 */
#include "fmi3_types.h"

fmi3Status true_fmi3GetFloat64(fmi3Instance instance, const fmi3ValueReference references[],
                               size_t count, fmi3Float64 values[], size_t value_count);
fmi3Status fmi3GetFloat64(fmi3Instance instance, const fmi3ValueReference references[],
                          size_t count, fmi3Float64 values[], size_t value_count);

fmi3Status fmi3GetFloat64(fmi3Instance instance, const fmi3ValueReference references[],
                          size_t count, fmi3Float64 values[], size_t value_count)
{
    const fmi3Status status =
        true_fmi3GetFloat64(instance, references, count, values, value_count);
    for (size_t n = 0; n < count; n++) values[n] = (float)values[n];
    return status;
}
