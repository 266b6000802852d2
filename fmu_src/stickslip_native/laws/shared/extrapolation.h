/* A stiff system of equations from one point to the next: the linearly implicit Euler method,
 * extrapolated.
 *
 * Source: Hairer and Wanner, Solving Ordinary Differential Equations II, 2nd ed., IV.9. */
#ifndef STICKSLIP_EXTRAPOLATION_H
#define STICKSLIP_EXTRAPOLATION_H

#include <stdbool.h>

/* The unknowns, and what is summed along them without acting on them. */
enum { UNKNOWNS = 3, SUMS = 2, COLUMNS = UNKNOWNS + SUMS };

/* The most rows of a table of extrapolation. */
enum { MOST_ROWS = 10 };

/* Rates of all columns at y, and their slopes over the unknowns unless that is NULL. */
typedef void field(const void *context, const double y[COLUMNS], double rates[COLUMNS],
                   double slopes[COLUMNS][UNKNOWNS]);

/* Whether a motion may go so far in one step; an implicit method steps over what grows. */
typedef bool reach(const void *context, const double from[COLUMNS], const double to[COLUMNS]);

/* Errors of an unknown count relative to least + gain |y|, or to most where that is less. */
struct scale {
    double least, gain, most;
};

struct system {
    field *field;
    reach *reach;
    const void *context;
    struct scale scales[UNKNOWNS];
    double heat; /* errors of the last sum count relative to this */
};

/* A step as it is tried or done: its length and the rows of its table. */
struct stride {
    double length;
    int rows;
};

/* The values that a stride leads to. */
void stride_to(const struct system *system, const double from[COLUMNS], struct stride stride,
               double to[COLUMNS]);

/* Go as far as one table goes at most, and half as often as errors ask for; `tried` becomes the
 * stride done, `next` one to try from there. False where none is short enough. */
bool stride_far(const struct system *system, const double from[COLUMNS], struct stride *tried,
                double to[COLUMNS], struct stride *next);

#endif
