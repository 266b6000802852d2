/* The end of an instance frees nothing.
 * replaces: instance_free
 * detected by: call-sequences in 300 sequences
 */
#include "instance.h"

void instance_free(struct instance *it)
{
    (void)it;
}
