/* A state that is read from bytes has no work of the pulling end.
 * replaces: block_restore
 * detected by: serialized-state-to-the-bit in default
 */
#include "block.h"

enum refusal true_block_restore(struct block *block, const struct block_state *saved);

enum refusal block_restore(struct block *block, const struct block_state *saved)
{
    const enum refusal refused = true_block_restore(block, saved);
    block->W_pull = (struct sum){0.0, 0.0};
    return refused;
}
