/* A change of an input makes the stick as old as the arc that it ends.
 * replaces: age_of
 * detected by: t_event-course in dwell-pull-changes
 */
#include "block.h"

double age_of(const struct block *block);

double age_of(const struct block *block)
{
    return block->arc.mode == 0 ? block->elapsed.high : 0.0;
}
