/* F_s shows what a fresh stick holds, however long the mass rests.
 * replaces: block_refresh
 * detected by: break-away-force-is-mu_s-N in dwell-growth
 */
#include "block.h"

enum refusal true_block_refresh(struct block *block);

enum refusal block_refresh(struct block *block)
{
    const enum refusal refused = true_block_refresh(block);
    block->F_s = block->friction.F_s;
    return refused;
}
