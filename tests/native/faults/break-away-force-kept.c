/* F_s shows the break-away force of the start, whatever load and mu_s do.
 * replaces: adopt_settings
 * detected by: F_s-course in load-pulses
 */
#include "block.h"

enum refusal true_adopt_settings(struct block *block, const struct friction *before);
enum refusal adopt_settings(struct block *block, const struct friction *before);

enum refusal adopt_settings(struct block *block, const struct friction *before)
{
    const double kept = block->F_s;
    const enum refusal refused = true_adopt_settings(block, before);
    if (before != NULL) block->F_s = kept;
    return refused;
}
