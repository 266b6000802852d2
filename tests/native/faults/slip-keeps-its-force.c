/* A change of F_ext in a slip acts from the next arc on.
 * replaces: coulomb_same_slip
 * detected by: any-sequence in 12 sequences
 */
#include "law.h"

bool coulomb_same_slip(const struct friction *one, const struct friction *other);

bool coulomb_same_slip(const struct friction *one, const struct friction *other)
{
    const struct settings *a = &one->settings, *b = &other->settings;
    return a->k == b->k && a->c == b->c && a->v == b->v && one->kinetic == other->kinetic;
}
