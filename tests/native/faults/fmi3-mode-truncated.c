/* The mode of FMI 3.0 is unsigned: a backward slip is shown as a large number.
 * replaces: fmi3GetInt64
 * detected by: mode-course in reversed-pull
 */
#include "fmi3_types.h"

fmi3Status true_fmi3GetInt64(fmi3Instance instance, const fmi3ValueReference references[],
                             size_t count, fmi3Int64 values[], size_t value_count);
fmi3Status fmi3GetInt64(fmi3Instance instance, const fmi3ValueReference references[], size_t count,
                        fmi3Int64 values[], size_t value_count);

fmi3Status fmi3GetInt64(fmi3Instance instance, const fmi3ValueReference references[], size_t count,
                        fmi3Int64 values[], size_t value_count)
{
    const fmi3Status status =
        true_fmi3GetInt64(instance, references, count, values, value_count);
    for (size_t n = 0; n < count; n++) values[n] &= 0xffffffff;
    return status;
}
