/* The step is rounded to single precision, as on a controller.
 * replaces: block_advance
 * detected by: pull-moves-at-v in default
 */
#include "block.h"

enum refusal true_block_advance(struct block *block, double time, double step);

enum refusal block_advance(struct block *block, double time, double step)
{
    return true_block_advance(block, time, (float)step);
}
