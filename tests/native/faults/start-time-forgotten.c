/* t_event counts from zero instead of the start time until the first transition.
 * replaces: block_start
 * detected by: starts-at-start-time
 */
#include "block.h"

enum refusal true_block_start(struct block *block, const struct settings *settings,
                              double start_time);

enum refusal block_start(struct block *block, const struct settings *settings, double start_time)
{
    (void)start_time;
    return true_block_start(block, settings, 0.0);
}
