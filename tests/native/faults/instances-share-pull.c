/* The speed of the pull that one instance gets moves all instances.
 * replaces: instance_set, instance_step
 * detected by: two-at-once in 12 sequences
 */
#include "instance.h"

bool true_instance_set(struct instance *it, const struct type *type, uint32_t reference,
                       double value);
bool true_instance_step(struct instance *it, double time, double step, bool starts);

static double pull;
static bool pulled;

bool instance_set(struct instance *it, const struct type *type, uint32_t reference, double value)
{
    if (reference == VR_v) pull = value;
    pulled = pulled || reference == VR_v;
    return true_instance_set(it, type, reference, value);
}

bool instance_step(struct instance *it, double time, double step, bool starts)
{
    if (pulled) block_set(&it->now.block, VR_v, pull);
    return true_instance_step(it, time, step, starts);
}
