/* The first slip of many runs, for callers in another language: batch.py. */
#include "block.h"
#include "export.h"
#include "text.h"

#include <math.h>

/* What a caller gets of each run; of a law without a stick it is that of the steady cycle. */
struct first_slip {
    double t_stick;     /* length of the stick before the slip [s] */
    double t_slip;      /* length of the slip [s] */
    double delta_x;     /* displacement of the mass in it [m] */
    double spring_drop; /* fall of z over it [m] */
    double x_dot_peak;  /* velocity of largest magnitude in it [m/s] */
};

/* A slip of more arcs than this has no end for the caller: far more than any that comes to rest. */
enum { MOST_ARCS = 100000 };

/* Cycles after which a motion that has not settled has none. */
enum { MOST_CYCLES = 100 };

size_t first_slips(const struct settings runs[], size_t count, struct first_slip found[],
                   char reason[MESSAGE_SIZE]);

/* What is more than rounding of the speed, relative to the highest of the slip. */
static const double SEEN = 1e-6;

/* A cycle whose fall is that of the one before is steady; falls this small beside the largest die
 * away. */
static const double SETTLED = 1e-7, DIES = 1e-3;

/* A mass sticks where its velocity falls below this part of the pull's. */
static const double STICKS = 0.01;

/* Go through the end of an arc into the next one; `extreme` is the velocity of largest magnitude in
 * the arc if it was a slip [m/s]. */
static enum refusal pass_end(const struct friction *law, struct arc *arc, struct meter *meter,
                             double *extreme)
{
    const struct arc ended = *arc;
    const struct arc_functions *functions = ARCS[ended.tag];
    const struct motion end = functions->end(&ended);
    *extreme = functions->extreme_velocity(&ended, ended.duration);
    if (ended.mode == 0)
        meter_pass_stick(meter, ended.duration);
    else
        meter_pass_slip(meter, ended.duration, end.displacement, -end.growth, *extreme);
    return LAW.after(law, &ended, ended.z_start + end.growth, arc);
}

/* The steady cycle of a law without a stick that a start reaches; none where falls of the spring
 * die away or take too many arcs. One that never sticks has a slip and no stick. */
static enum refusal steady_slip(const struct settings *settings, struct first_slip *found)
{
    struct friction law;
    struct meter meter;
    struct arc arc;
    double extreme, before = 0.0, largest = 0.0, slowest = HUGE_VAL;
    enum refusal refused = LAW.under(&law, settings, NULL);
    if (refused == ACCEPTED)
        refused = LAW.begin(&law, 0, settings->z_start, settings->x_dot_start, 0.0, NULL, &arc);
    if (refused != ACCEPTED) return refused;
    *found = (struct first_slip){HUGE_VAL, NAN, NAN, NAN, NAN};
    meter_start(&meter, 0.0);
    for (int n = 0; n < MOST_ARCS && meter.n_slips < MOST_CYCLES; n++) {
        const int mode = arc.mode;
        if (mode == 0) slowest = fmin(slowest, fabs(arc.x_dot_start));
        refused = pass_end(&law, &arc, &meter, &extreme);
        if (refused != ACCEPTED) return refused;
        if (arc.mode == mode) continue;
        if (mode == 0) {
            meter_break_away(&meter, 0.0);
            continue;
        }
        meter_end_slip(&meter, 0.0);
        const double drop = fabs(meter.spring_drop);
        largest = fmax(largest, drop);
        if (drop < DIES * largest) return ACCEPTED;
        if (fabs(drop - before) <= SETTLED * drop) {
            found->t_slip = meter.t_slip;
            if (slowest > STICKS * fabs(settings->v)) return ACCEPTED;
            *found = (struct first_slip){meter.t_stick, meter.t_slip, meter.delta_x,
                                         meter.spring_drop, meter.x_dot_peak};
            return ACCEPTED;
        }
        before = drop;
        slowest = HUGE_VAL;
    }
    return ACCEPTED;
}

static enum refusal first_slip(const struct settings *settings, struct first_slip *found)
{
    if (LAW.whole) return steady_slip(settings, found);
    const double x_dot = settings->x_dot_start;
    struct friction law;
    struct meter meter;
    struct arc arc;
    double extreme;
    enum refusal refused = LAW.under(&law, settings, NULL);
    if (refused != ACCEPTED) return refused;
    meter_start(&meter, 0.0);
    refused = LAW.begin(&law, x_dot == 0.0 ? 0 : x_dot > 0.0 ? 1 : -1, settings->z_start, x_dot, 0.0,
                        NULL, &arc);
    if (refused != ACCEPTED) return refused;
    *found = (struct first_slip){HUGE_VAL, NAN, NAN, NAN, NAN};
    if (arc.mode == 0) {
        if (arc.duration == HUGE_VAL) return ACCEPTED;
        refused = pass_end(&law, &arc, &meter, &extreme);
        if (refused != ACCEPTED) return refused;
        meter_break_away(&meter, 0.0);
    }
    found->t_stick = meter.t_stick;
    found->t_slip = HUGE_VAL;
    const int mode = arc.mode;
    /* The highest speed so far, and the lowest that it has fallen to from there. */
    double highest = 0.0, lowest = HUGE_VAL;
    for (int n = 0; arc.mode == mode; n++) {
        if (arc.duration == HUGE_VAL || n == MOST_ARCS) return ACCEPTED;
        const double speed = mode * arc.x_dot_start;
        if (speed < highest - SEEN * highest && speed < lowest) lowest = speed;
        refused = pass_end(&law, &arc, &meter, &extreme);
        if (refused != ACCEPTED) return refused;
        /* From rest the speed that rises again never falls to rest: docs/theory.md (30). */
        if (x_dot == 0.0 && mode * extreme > lowest + SEEN * highest) return ACCEPTED;
        if (mode * extreme > highest) highest = mode * extreme;
    }
    meter_end_slip(&meter, 0.0);
    *found = (struct first_slip){meter.t_stick, meter.t_slip, meter.delta_x, meter.spring_drop,
                                 meter.x_dot_peak};
    return isfinite(meter.delta_x + meter.spring_drop) ? ACCEPTED : NOT_FINITE;
}

/* Compute `count` runs; return the number of those before the first one that is refused, and why. */
STICKSLIP_EXPORT size_t first_slips(const struct settings runs[], size_t count,
                                    struct first_slip found[], char reason[MESSAGE_SIZE])
{
    for (size_t n = 0; n < count; n++) {
        const enum refusal refused = first_slip(&runs[n], &found[n]);
        if (refused == ACCEPTED) continue;
        refusal_text(refused, &runs[n], 0.0, 0.0, reason);
        return n;
    }
    return count;
}
