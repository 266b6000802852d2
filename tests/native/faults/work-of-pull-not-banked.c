/* The work of the pulling end starts at zero in each arc.
 * replaces: bank
 * detected by: energy-balance in default
 */
#include "block.h"

void true_bank(struct block *block, double tau, struct motion motion);
void bank(struct block *block, double tau, struct motion motion);

void bank(struct block *block, double tau, struct motion motion)
{
    true_bank(block, tau, motion);
    block->W_pull = (struct sum){0.0, 0.0};
}
