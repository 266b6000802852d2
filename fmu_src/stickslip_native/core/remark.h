/* What a friction law says about settings: a text with holes, and the values for them. */
#ifndef STICKSLIP_REMARK_H
#define STICKSLIP_REMARK_H

enum { MOST_VALUES = 4, MOST_REMARKS = 4 };

/* Each hole takes the next value: %r is a Real, %d an Integer, %n the name of the variable whose
 * value reference the value is. There is no other %. */
struct remark {
    const char *text; /* lasts as long as the library */
    double values[MOST_VALUES]; /* 0 beyond the holes */
};

#endif
