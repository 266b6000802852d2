/* The heat of a block that starts is what was in its memory.
 * replaces: block_start
 * detected by: reset-to-the-bit in default
 */
#include "block.h"

enum refusal true_block_start(struct block *block, const struct settings *settings,
                              double start_time);

enum refusal block_start(struct block *block, const struct settings *settings, double start_time)
{
    const struct sum heat = block->Q_friction;
    const enum refusal refused = true_block_start(block, settings, start_time);
    block->Q_friction = heat;
    return refused;
}
