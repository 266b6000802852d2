/* The checksum of a state is that of no bytes, so a changed byte is not seen.
 * replaces: hash_of
 * detected by: damaged-states
 */
#include "bytes.h"

uint64_t hash_of(const void *bytes, size_t count)
{
    (void)bytes, (void)count;
    return 0;
}
