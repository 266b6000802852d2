/* The settings of a state may be out of their ranges.
 * replaces: within_bounds
 * detected by: damaged-states
 */
#include "text.h"

bool within_bounds(const struct settings *values, char reason[MESSAGE_SIZE]);

bool within_bounds(const struct settings *values, char reason[MESSAGE_SIZE])
{
    (void)values, (void)reason;
    return true;
}
