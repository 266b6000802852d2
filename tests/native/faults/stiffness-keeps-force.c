/* A change of k keeps the force and moves the extension.
 * replaces: change_settings
 * detected by: pull-moves-at-v in tuned
 */
#include "block.h"

enum refusal true_change_settings(struct block *block, double time);
enum refusal change_settings(struct block *block, double time);

enum refusal change_settings(struct block *block, double time)
{
    const double before = block->friction.settings.k;
    const enum refusal refused = true_change_settings(block, time);
    block->arc.z_start *= before / block->friction.settings.k;
    return refused;
}
