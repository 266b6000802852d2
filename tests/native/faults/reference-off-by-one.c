/* The reference behind the last variable is taken.
 * replaces: has
 * detected by: call-sequences in 300 sequences
 */
#include "instance.h"

bool true_has(const struct type *type, uint32_t reference);
bool has(const struct type *type, uint32_t reference);

bool has(const struct type *type, uint32_t reference)
{
    return reference == VARIABLES || true_has(type, reference);
}
