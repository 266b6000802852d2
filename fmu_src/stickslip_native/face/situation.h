/* Everything that a later call depends on: what a state of an instance holds. */
#ifndef STICKSLIP_SITUATION_H
#define STICKSLIP_SITUATION_H

#include "continuous.h"
#include "ramp.h"

#include <stdbool.h>

enum phase {
    INSTANTIATED,
    INITIALIZATION,
    STEPPING,
    EVENT_DUE,
    EVENT_MODE,
    CONTINUOUS,
    TERMINATED,
    PHASES
};

struct situation {
    struct block block;
    double time;            /* the start time, or the end of the last step [s] */
    enum phase phase;
    double rates[MOVING];   /* of the inputs in the next step, if they move [1/s] */
    bool moves;
    bool settled; /* whether the block was started from what was set */
    bool holds;   /* whether discrete outputs are held from event mode to event mode */
    bool solved;  /* whether a solver of the simulator's moves the block, from its start on */
    union {
        double held[DISCRETE];    /* the outputs that are held, where they are */
        struct continuous solver; /* where one moves the block */
    } of;
};

#endif
