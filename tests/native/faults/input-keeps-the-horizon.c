/* A value that is set leaves the horizon of the arc: it acts only after the next event.
 * replaces: block_set
 * detected by: any-sequence in 12 sequences
 */
#include "block.h"

void true_block_set(struct block *block, enum reference reference, double value);

void block_set(struct block *block, enum reference reference, double value)
{
    const double horizon = block->horizon;
    true_block_set(block, reference, value);
    block->horizon = horizon;
}
