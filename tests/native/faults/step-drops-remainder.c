/* The rest of a communication step after an event is dropped.
 * replaces: pass_event
 * detected by: pull-moves-at-v in default
 */
#include "block.h"

void true_pass_event(struct block *block, double time);
void pass_event(struct block *block, double time);

void pass_event(struct block *block, double time)
{
    true_pass_event(block, time);
    block->x_start.high -= 1e-6;
}
