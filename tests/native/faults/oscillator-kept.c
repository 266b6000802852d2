/* The oscillator of before is kept where k did not change, so a new damping does not act.
 * replaces: coulomb_under
 * detected by: any-sequence in 12 sequences
 */
#include "law.h"

enum refusal true_coulomb_under(struct friction *made, const struct settings *settings,
                                const struct friction *before);
enum refusal coulomb_under(struct friction *made, const struct settings *settings,
                           const struct friction *before);

enum refusal coulomb_under(struct friction *made, const struct settings *settings,
                           const struct friction *before)
{
    const struct oscillator *old = before == NULL ? NULL : &before->of.coulomb.oscillator;
    struct oscillator kept;
    if (old != NULL) kept = *old;
    const enum refusal refused = true_coulomb_under(made, settings, before);
    if (old != NULL && settings->k == kept.k) made->of.coulomb.oscillator = kept;
    return refused;
}
