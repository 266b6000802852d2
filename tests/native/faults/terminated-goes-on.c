/* An instance that was terminated can step.
 * replaces: instance_terminate
 * detected by: call-sequences in 300 sequences
 */
#include "instance.h"

bool true_sound(struct instance *it);
bool sound(struct instance *it);
bool instance_terminate(struct instance *it)
{
    return it != NULL && !it->failed;
}
