/* After a reset the start time of the run before is still there: a field is missing.
 * replaces: instance_reset
 * detected by: call-sequences in 300 sequences
 */
#include "instance.h"

bool true_instance_reset(struct instance *it);

bool instance_reset(struct instance *it)
{
    const double time = it->now.time;
    const bool made = true_instance_reset(it);
    it->now.time = time;
    it->now.settled = false;
    return made;
}
