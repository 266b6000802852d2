/* At each event the mass jumps back by a micrometre.
 * replaces: pass_event
 * detected by: pull-moves-at-v in default
 */
#include "block.h"

enum refusal true_pass_event(struct block *block, double time);
enum refusal pass_event(struct block *block, double time);

enum refusal pass_event(struct block *block, double time)
{
    const enum refusal refused = true_pass_event(block, time);
    block->x_start.high -= 1e-6;
    return refused;
}
