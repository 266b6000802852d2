/* Why the block refuses values, a step or a state. The texts are made by the caller. */
#ifndef STICKSLIP_REFUSAL_H
#define STICKSLIP_REFUSAL_H

enum refusal {
    ACCEPTED,
    LIFTED_OFF,           /* the load that is set would lift the mass */
    NOT_FINITE,           /* the motion or its forces leave the range of doubles */
    RATES_OUT_OF_RANGE,   /* k, m and c together give a rate beyond the range of doubles */
    STEP_OUT_OF_RANGE,    /* step size not above 0, or not finite */
    TIME_OUT_OF_RANGE,    /* communication point not finite */
    TOO_MANY_TRANSITIONS, /* the step holds more than MOST_TRANSITIONS transitions */
    LAW_REFUSES,          /* the friction law refuses the settings: its member `refuses` */
    NOT_FOLLOWED,         /* the motion is stiffer than doubles can follow */
    NO_SUCH_STATE         /* saved values that no block reaches */
};

#endif
