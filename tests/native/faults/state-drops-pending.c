/* A state that is written as bytes forgets what was set and has not acted yet.
 * replaces: block_save
 * detected by: carried-over in 12 sequences
 */
#include "block.h"

void true_block_save(const struct block *block, struct block_state *saved);

void block_save(const struct block *block, struct block_state *saved)
{
    true_block_save(block, saved);
    saved->changed = false;
}
