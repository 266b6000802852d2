/* A step in which inputs move: docs/theory.md (32).
 *
 * Pull, load and external force go at a constant rate from the values last set to those at the end of
 * the step. The motion is a chain of power series, of which none misses a zero: polynomial.h. */
#ifndef STICKSLIP_RAMP_H
#define STICKSLIP_RAMP_H

#include "block.h"

/* The inputs that move, and their value references. */
enum { MOVING = 3 };
extern const enum reference MOVES[MOVING];

/* Move on by one communication step [s] from this time [s], at the end of which the inputs have these
 * values; they keep them then. After TOO_MANY_TRANSITIONS the block is as it was. */
enum refusal ramp_advance(struct block *block, double time, double step,
                          const double ends[MOVING]);

#endif
