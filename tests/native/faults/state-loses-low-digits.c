/* A state as bytes has one double of each running sum.
 * replaces: block_save
 * detected by: serialized-state-to-the-bit in default
 */
#include "block.h"

void true_block_save(const struct block *block, struct block_state *saved);

void block_save(const struct block *block, struct block_state *saved)
{
    true_block_save(block, saved);
    saved->elapsed.low = saved->x_start.low = saved->W_pull.low = 0.0;
}
