/* A second step goes on after the instance has failed.
 * replaces: prepare_step
 * detected by: call-sequences in 300 sequences
 */
#include "instance.h"

bool true_prepare_step(struct instance *it);
bool prepare_step(struct instance *it);

bool prepare_step(struct instance *it)
{
    return it->failed || true_prepare_step(it);
}
