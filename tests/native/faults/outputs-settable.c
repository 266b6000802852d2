/* A value that is set where an output stands is dropped without a refusal.
 * replaces: instance_set
 * detected by: call-sequences in 300 sequences
 */
#include "instance.h"

bool true_instance_set(struct instance *it, const struct type *type, uint32_t reference,
                       double value);

bool instance_set(struct instance *it, const struct type *type, uint32_t reference, double value)
{
    if (reference < VARIABLES && !ROWS[reference].settable) return true;
    return true_instance_set(it, type, reference, value);
}
