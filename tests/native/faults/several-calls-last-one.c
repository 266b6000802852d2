/* Of several calls that set values before a step the last one acts.
 * replaces: instance_begin_set
 * detected by: set-one-by-one in 12 sequences
 */
#include "instance.h"

bool true_instance_begin_set(struct instance *it, const char *call, const struct type *type,
                             const uint32_t references[], size_t count, const void *values,
                             size_t value_count);

bool instance_begin_set(struct instance *it, const char *call, const struct type *type,
                        const uint32_t references[], size_t count, const void *values,
                        size_t value_count)
{
    if (it->now.phase == STEPPING) it->now.values = it->now.block.friction.settings;
    if (it->now.phase == STEPPING) it->now.block.wanted = it->now.values;
    return true_instance_begin_set(it, call, type, references, count, values, value_count);
}
