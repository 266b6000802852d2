/* A state that is read from bytes has a horizon that is none of its arc: a stale cache.
 * replaces: block_restore
 * detected by: serialized-state-to-the-bit in default
 */
#include "block.h"

#include <math.h>

enum refusal true_block_restore(struct block *block, const struct block_state *saved);

enum refusal block_restore(struct block *block, const struct block_state *saved)
{
    const enum refusal refused = true_block_restore(block, saved);
    block->horizon = HUGE_VAL;
    return refused;
}
