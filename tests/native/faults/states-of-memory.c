/* States that the simulator has freed are kept.
 * replaces: instance_free_state
 * detected by: call-sequences in 300 sequences
 */
#include "instance.h"

bool instance_free_state(struct instance *it, const char *call, void **handle)
{
    (void)it, (void)call;
    *handle = NULL;
    return true;
}
