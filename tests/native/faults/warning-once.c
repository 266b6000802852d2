/* The clamp is told once in the life of an instance.
 * replaces: same_remark
 * detected by: call-sequences in 300 sequences
 */
#include "text.h"

bool same_remark(const struct remark *one, const struct remark *other)
{
    (void)one, (void)other;
    return true;
}
