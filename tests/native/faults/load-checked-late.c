/* A load that lifts the mass is refused by the next step and not where it is set.
 * replaces: block_check
 * detected by: call-sequences in 1000 sequences
 */
#include "block.h"

enum refusal block_check(const struct block *block)
{
    (void)block;
    return ACCEPTED;
}
