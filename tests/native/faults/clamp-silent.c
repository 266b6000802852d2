/* The clamp acts without a warning.
 * replaces: coulomb_warns
 * detected by: warns-of-clamp
 */
#include "law.h"

bool coulomb_warns(const struct settings *settings);

bool coulomb_warns(const struct settings *settings)
{
    (void)settings;
    return false;
}
