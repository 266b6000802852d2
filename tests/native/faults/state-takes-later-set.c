/* Setting a state keeps the values that were set after it was taken.
 * replaces: instance_set_state
 * detected by: set-back in 12 sequences
 */
#include "instance.h"

bool true_instance_set_state(struct instance *it, const void *handle);

bool instance_set_state(struct instance *it, const void *handle)
{
    const struct settings wanted = it->now.block.wanted;
    const bool taken = true_instance_set_state(it, handle);
    it->now.block.wanted = wanted;
    return taken;
}
