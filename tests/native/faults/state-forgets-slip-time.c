/* Setting a state goes back to the start of the arc, not to the time on it.
 * replaces: instance_set_state
 * detected by: rollback-to-the-bit in default
 */
#include "instance.h"

bool true_instance_set_state(struct instance *it, const void *handle);

bool instance_set_state(struct instance *it, const void *handle)
{
    const bool taken = true_instance_set_state(it, handle);
    it->now.block.elapsed = (struct sum){0.0, 0.0};
    it->now.block.stale = true;
    return taken;
}
