/* After a refused call the next calls succeed.
 * replaces: sound
 * detected by: fails-until-reset
 */
#include "instance.h"

bool sound(struct instance *it);

bool sound(struct instance *it)
{
    it->failed = false;
    return true;
}
