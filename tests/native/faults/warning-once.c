/* The clamp is told once in the life of an instance.
 * replaces: same_warning
 * detected by: call-sequences in 300 sequences
 */
#include "text.h"

bool same_warning(const struct settings *one, const struct settings *other)
{
    (void)one, (void)other;
    return true;
}
