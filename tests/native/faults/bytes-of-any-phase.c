/* The phase of a state may be any number.
 * replaces: consistent
 * detected by: damaged-states
 */
#include <stdbool.h>

struct saved;

bool consistent(const struct saved *it);

bool consistent(const struct saved *it)
{
    (void)it;
    return true;
}
