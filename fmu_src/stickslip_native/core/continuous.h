/* The block as a system of equations that a solver of the caller's integrates: docs/theory.md (1).
 *
 * Between events the mode does not change, so the right-hand side is smooth: in stick the mass rests
 * exactly, in slip it moves in one direction. An event is where an indicator changes its sign, and
 * where the arc that begins at the last event would end if nothing moved: a solver that looks for
 * changes of sign at the ends of its steps alone misses slips that hardly come to rest. At an event
 * the block stands anew at what the solver found, and the meter is that of the block. */
#ifndef STICKSLIP_CONTINUOUS_H
#define STICKSLIP_CONTINUOUS_H

#include "block.h"

#include <float.h>

/* The states of the solver, and after their derivatives the indicators. */
enum { STATE_X, STATE_X_DOT, STATE_Z, STATE_W_PULL, STATE_Q_FRICTION, STATES };
enum { INDICATORS = 2 };

struct continuous {
    double time;           /* [s] */
    double states[STATES]; /* [m, m/s, m, J, J] */
    double entered;        /* time of the last event [s] */
    double due;            /* time of the next one as far as nothing moves, DBL_MAX if unknown [s] */
    double peak;           /* extreme velocity of the slip up to the last event [m/s] */
    double v, load, F_ext; /* inputs at the last event [m/s, N, N] */
    bool moved;            /* one of them changed since, by more than rounding */
};

/* Begin where the block stands, at this time [s]. */
void continuous_start(struct continuous *it, const struct block *block, double time);

/* Note whether inputs moved that were set, and let them act. */
void continuous_note(struct continuous *it, const struct block *block);
enum refusal continuous_adopt(struct block *block);

/* Derivatives of the states, and the indicators. */
void continuous_rates(const struct continuous *it, const struct block *block,
                      double rates[STATES]);
void continuous_indicators(const struct continuous *it, const struct block *block,
                           double indicators[INDICATORS]);

/* Orders of magnitude of the states, each above 0. */
void continuous_nominals(const struct block *block, double nominals[STATES]);

/* Go through an event: changes of mode that are due, settings last set. States may change. */
enum refusal continuous_update(struct continuous *it, struct block *block);

/* Read an output between events. */
enum refusal continuous_read(const struct continuous *it, struct block *block,
                             enum reference reference, double *value);

#endif
