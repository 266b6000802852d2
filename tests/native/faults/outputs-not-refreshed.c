/* A step leaves the outputs of before as they were.
 * replaces: block_advance
 * detected by: pull-moves-at-v in default
 */
#include "block.h"

enum refusal true_block_advance(struct block *block, double time, double step);

enum refusal block_advance(struct block *block, double time, double step)
{
    const bool stale = block->stale;
    const enum refusal refused = true_block_advance(block, time, step);
    block->stale = stale;
    return refused;
}
