/* The first stick counts as new, whatever age_start says.
 * replaces: coulomb_forces
 * detected by: t_stick-course in dwell-first-stick
 */
#include "law.h"

enum refusal true_coulomb_forces(struct friction *it, double *mu_k_used);

enum refusal coulomb_forces(struct friction *it, double *mu_k_used)
{
    const enum refusal refused = true_coulomb_forces(it, mu_k_used);
    it->age_start = 0.0;
    return refused;
}
