/* Energies are rounded to single precision.
 * replaces: energy
 * detected by: W_pull-course in default
 */
#include "block.h"

enum refusal true_energy(struct sum before, double since, double *value);
enum refusal energy(struct sum before, double since, double *value);

enum refusal energy(struct sum before, double since, double *value)
{
    const enum refusal refused = true_energy(before, since, value);
    *value = (float)*value;
    return refused;
}
