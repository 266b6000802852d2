/* A start in motion begins at rest.
 * replaces: block_start
 * detected by: x_dot-course in moving-start
 */
#include "block.h"

enum refusal true_block_start(struct block *block, const struct settings *settings,
                              double start_time);

enum refusal block_start(struct block *block, const struct settings *settings, double start_time)
{
    struct settings still = *settings;
    still.x_dot_start = 0.0;
    return true_block_start(block, &still, start_time);
}
