/* Kinetic friction is mu_k m g: the load acts on static friction only.
 * replaces: coulomb_under
 * detected by: slip-friction in loaded
 */
#include "law.h"

enum refusal true_coulomb_under(struct friction *made, const struct settings *settings,
                                const struct friction *before);
enum refusal coulomb_under(struct friction *made, const struct settings *settings,
                           const struct friction *before);

enum refusal coulomb_under(struct friction *made, const struct settings *settings,
                           const struct friction *before)
{
    const enum refusal refused = true_coulomb_under(made, settings, before);
    made->kinetic = made->of.coulomb.mu_k_used * settings->m * settings->g;
    made->gap = made->F_s - made->kinetic;
    return refused;
}
