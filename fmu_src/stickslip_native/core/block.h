/* The stick-slip block: inputs and parameters in, exact motion out, from event to event.
 *
 * The block walks along arcs, which its friction law makes (law.h). A communication step only moves
 * along the arc. A new arc starts at an event, or at the first step after an input or parameter
 * took another value; nothing else re-bases the motion.
 *
 * A block holds no pointer and no resource: a state is a copy of the struct. No function keeps
 * anything between two calls, allocates, locks, prints or depends on the locale. After a call that
 * does not return ACCEPTED the block is good for nothing but `block_start`, a copy, or the text of
 * the refusal. */
#ifndef STICKSLIP_BLOCK_H
#define STICKSLIP_BLOCK_H

#include "law.h"
#include "meter.h"
#include "numerics.h"
#include "refusal.h"
#include "table.h"

#include <stdbool.h>
#include <stddef.h>

/* What one step may hold: above it the caller would wait for minutes, so the step is refused. */
enum { MOST_TRANSITIONS = 1 << 24 };

struct block {
    struct settings wanted;   /* as last set: they act from the next step on */
    struct friction friction; /* the law under the settings that hold, with those */
    struct arc arc;           /* that the block moves along */
    struct sum elapsed;       /* time since the start of the arc [s] */
    double horizon;           /* up to here a step only moves along the arc [s] */
    struct sum x_start;       /* position of the mass at the start of the arc [m] */
    struct sum W_pull, W_k, Q_friction; /* energies at the start of the arc [J] */
    struct meter meter;
    bool started; /* a step was made */
    bool changed; /* `wanted` is to be taken up */
    bool stale;   /* the block moved since block_refresh computed what follows */
    double x, x_dot, x_pull, z, displacement;
    double F, F_friction, F_s;
    struct own own;
    int mode; /* -1 slips backward, 0 sticks, +1 slips forward */
};

/* What determines a block, for writing it out. The arc follows from `start` and the settings. */
struct block_state {
    struct settings wanted, settings;
    struct start start;
    struct sum elapsed, x_start, W_pull, W_k, Q_friction;
    struct meter meter;
    bool started, changed;
};

/* Bytes of a block, for callers in another language. */
size_t block_size(void);

/* Begin with these settings; until the first transition t_event shows the start time [s]. */
enum refusal block_start(struct block *block, const struct settings *settings, double start_time);

/* Set the input or tunable parameter of this value reference; it acts from the next step on. */
void block_set(struct block *block, enum reference reference, double value);

/* Whether the settings last set go together: LIFTED_OFF where the load would lift the mass. */
enum refusal block_check(const struct block *block);

/* Move on by one communication step [s] from this time [s], which dates t_event and nothing else.
 * After TOO_MANY_TRANSITIONS the block is as it was. */
enum refusal block_advance(struct block *block, double time, double step);

/* Let what was set act at this time [s], and stand at the start of an arc where the block is, for a
 * motion along no arc; `age` is the time at rest [s]. */
enum refusal block_lift(struct block *block, double time, double *age);

/* Begin an arc at this time [s] where such a motion led to, under the settings last set. */
enum refusal block_land(struct block *block, double time, int mode, double z, double x_dot,
                        double age);

/* Where a step ended: at its end, or at the first change of mode in it. */
struct stop {
    double time; /* [s] */
    bool event;  /* a change of mode is due there: block_settle goes through it */
};

/* As block_advance, but no further than to the first change of mode, and not through it: outputs
 * show their limits from before. The time told is the first double at which the change is over;
 * steps that go on from it give what one step would, as what it is late by is kept. */
enum refusal block_advance_to_event(struct block *block, double time, double step,
                                    struct stop *stop);

/* Go through all that is due at this time [s]: a change of mode, settings last set, the start. */
enum refusal block_settle(struct block *block, double time);

/* Time of the next change of mode [s] as seen from this time, infinity where none is known. It holds
 * as long as nothing is set. */
double block_next_event(const struct block *block, double time);

/* Read the variable of this value reference, refreshed where the block moved: a Boolean is 0 or 1,
 * a parameter or input is the value last set. */
enum refusal block_read(struct block *block, enum reference reference, double *value);

/* Compute the motion where the block stands. */
enum refusal block_refresh(struct block *block);

void block_save(const struct block *block, struct block_state *saved);

/* Take up a saved state, bit for bit, with the arc made anew; NO_SUCH_STATE where it has values
 * that no block reaches. Each number must be finite, each setting within its bounds. */
enum refusal block_restore(struct block *block, const struct block_state *saved);

#endif
