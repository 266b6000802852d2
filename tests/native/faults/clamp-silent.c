/* The clamp acts without a warning.
 * replaces: coulomb_remarks
 * detected by: warns-of-clamp
 */
#include "law.h"

int coulomb_remarks(const struct settings *settings, struct remark made[MOST_REMARKS]);

int coulomb_remarks(const struct settings *settings, struct remark made[MOST_REMARKS])
{
    (void)settings, (void)made;
    return 0;
}
