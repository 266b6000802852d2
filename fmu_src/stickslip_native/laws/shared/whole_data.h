/* The data of a motion whole, for a law whose header has defined `struct medium`. */
#ifndef STICKSLIP_WHOLE_DATA_H
#define STICKSLIP_WHOLE_DATA_H

/* How an arc ends: at the end of a stride, where the spring turns, or where the mass stops. */
enum whole_end { STRIDE_ENDS, SPRING_TURNS, MASS_STOPS };

struct whole {
    struct medium medium;
    double direction; /* of the velocity, +1 or -1 */
    double duration;  /* [s] */
    enum whole_end event;
    struct start start; /* with the stride that was tried */
    struct stride done, next;
    double from[COLUMNS], to[COLUMNS];
};

#endif
