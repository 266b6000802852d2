/* After a reset the values set before are still there.
 * replaces: instance_reset
 * detected by: call-sequences in 300 sequences
 */
#include "instance.h"

bool true_instance_reset(struct instance *it);

bool instance_reset(struct instance *it)
{
    const struct settings values = it->now.values;
    const bool was_used = it->now.phase != INSTANTIATED;
    const bool made = true_instance_reset(it);
    if (was_used) it->now.values = values;
    return made;
}
