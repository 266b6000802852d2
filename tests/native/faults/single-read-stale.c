/* Values are not refreshed where the list has one reference.
 * replaces: instance_begin_get
 * detected by: read-alone in 12 sequences
 */
#include "instance.h"

bool true_instance_begin_get(struct instance *it, const char *call, const struct type *type,
                             const uint32_t references[], size_t count, const void *values,
                             size_t value_count);

bool instance_begin_get(struct instance *it, const char *call, const struct type *type,
                        const uint32_t references[], size_t count, const void *values,
                        size_t value_count)
{
    if (count == 1) it->now.block.stale = false;
    return true_instance_begin_get(it, call, type, references, count, values, value_count);
}
