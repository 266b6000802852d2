/* A state of a friction law with other settings is read.
 * replaces: hash_of_names
 * detected by: damaged-states
 */
#include <stdint.h>

uint64_t hash_of_names(void);

uint64_t hash_of_names(void)
{
    static uint64_t count;
    return count++ < 1 ? 7 : 7;
}
