/* Debug logging cannot be switched off.
 * replaces: instance_log
 * detected by: call-sequences in 300 sequences
 */
#include "instance.h"

bool instance_log(struct instance *it, const char *call, bool on, size_t count,
                  const char *const categories[])
{
    (void)it, (void)call, (void)on, (void)count, (void)categories;
    return true;
}
