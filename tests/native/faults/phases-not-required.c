/* Calls are taken in every phase.
 * replaces: require
 * detected by: call-sequences in 300 sequences
 */
#include "instance.h"

bool require(struct instance *it, enum phase phase, const char *call);

bool require(struct instance *it, enum phase phase, const char *call)
{
    (void)it, (void)phase, (void)call;
    return true;
}
