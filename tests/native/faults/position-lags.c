/* x_pull is made from the position of the mass at the start of the arc.
 * replaces: block_refresh
 * detected by: extension-is-the-gap-of-the-ends in default
 */
#include "block.h"

enum refusal true_block_refresh(struct block *block);

enum refusal block_refresh(struct block *block)
{
    const enum refusal refused = true_block_refresh(block);
    block->x_pull = block->x_start.high + block->z;
    return refused;
}
