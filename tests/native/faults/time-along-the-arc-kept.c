/* A new arc begins with the time along the arc before it.
 * replaces: stand_at_start
 * detected by: pull-moves-at-v in force-pulses
 */
#include "block.h"

void stand_at_start(struct block *block);

void stand_at_start(struct block *block)
{
    block->mode = block->arc.mode;
}
