/* A variable is read through the function of any type.
 * replaces: has
 * detected by: call-sequences in 300 sequences
 */
#include "instance.h"

bool has(const struct type *type, uint32_t reference);

bool has(const struct type *type, uint32_t reference)
{
    (void)type;
    return reference < VARIABLES;
}
