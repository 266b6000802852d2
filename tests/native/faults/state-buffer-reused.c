/* All states of an instance are kept in the memory of the first one.
 * replaces: keep
 * detected by: call-sequences in 300 sequences
 */
#include "instance.h"

bool true_keep(struct instance *it, const char *call, const struct situation *situation,
               void **handle);
bool keep(struct instance *it, const char *call, const struct situation *situation, void **handle);

bool keep(struct instance *it, const char *call, const struct situation *situation, void **handle)
{
    static struct instance *owner;
    static void *first;
    if (owner == it) *handle = first;
    const bool kept = true_keep(it, call, situation, handle);
    owner = it;
    first = *handle;
    return kept;
}
