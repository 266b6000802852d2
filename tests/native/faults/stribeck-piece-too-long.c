/* Pieces are half as long again as their series hold; the check of the force shortens some.
 * law: stribeck
 * replaces: reach_of
 * detected by: equal-bits in 50 sequences
 */
#include "piece.h"

double true_reach_of(const struct piece *it);
double reach_of(const struct piece *it);

double reach_of(const struct piece *it)
{
    return 1.5 * true_reach_of(it);
}
