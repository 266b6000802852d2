/* The energy that a change of k puts in is not accounted for.
 * replaces: change_settings
 * detected by: energy-balance in tuned
 */
#include "block.h"

enum refusal true_change_settings(struct block *block, double time);
enum refusal change_settings(struct block *block, double time);

enum refusal change_settings(struct block *block, double time)
{
    const struct sum before = block->W_k;
    const enum refusal refused = true_change_settings(block, time);
    block->W_k = before;
    return refused;
}
