/* A read after a set clears the mark that something changed.
 * replaces: instance_get
 * detected by: read-one-by-one in 12 sequences
 */
#include "instance.h"

bool true_instance_get(struct instance *it, const struct type *type, const uint32_t references[],
                       size_t count, size_t position, double *value);

bool instance_get(struct instance *it, const struct type *type, const uint32_t references[],
                  size_t count, size_t position, double *value)
{
    it->now.block.changed = false;
    return true_instance_get(it, type, references, count, position, value);
}
