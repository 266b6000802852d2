/* The motion of a servo axis from event to event, as motion.py has it: docs/feed-axis.md (1), (2).
 *
 * Sample by sample: the controller is a list of the entries of its matrix; between the samples
 * motor, table and current loop are linear, under a commanded force that is constant. */
#if defined __GNUC__ && !defined __clang__
/* Small products are unrolled: half the time. */
#pragma GCC optimize("O3")
#endif
#include "export.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

/* Places in the state: system.py. */
enum { MOTOR, MOTOR_SPEED, TABLE, SPEED, FORCE, PLANT };
/* What moves the plant beside its own state: the commanded force, and the number 1. */
enum { PUSH = PLANT, ONE, WIDTH };
enum { INTEGRAL = 5, LAST };

enum event {
    TIME,
    STOP,
    FORWARD,
    BACKWARD,
    SLOWER,
    FASTER,
    MOTOR_STOPS,
    MOTOR_FORWARD,
    MOTOR_BACKWARD,
    PEAK,
    DIP
};
enum { MOST_MARGINS = 5, TERMS = 15, TERMS_OF_STATE = 19 };
/* Samples of a short and of a long block, which is passed at once where no event can come; a block
 * is computed the OFTEN-th time it is asked for, and no more than FEW_PARTS of a sample may be
 * needed. As many short blocks in a row as a long one has are followed by long ones. */
enum { SHORT = 8, LONG = 64, OFTEN = 4, FEW_PARTS = 10, SEEN = 3 };

/* What is left of a part of a sample counts as none, relative to the sample. */
static const double NONE = 1e-12;
/* Even motion, and motion whose extremes are rounding: within this of the feed, relative. */
static const double EVEN = 1e-2, STILL = 1e-6;

struct line {
    double low, high, force, slope;
};

/* An entry of the controller's matrix, in the order of the rows. */
struct entry {
    double value;
    int row, column;
};

/* An axis: system.py. Lengths and rates are SI; the arrays behind `steps` are for this file. */
struct axis {
    double k, m, c, along, inertia, d, dry, lag, sample, fully;
    const double *lengths, *offsets, *rates, *forces, *decays;
    const struct line *lines;
    const struct entry *control;
    double *steps;    /* of each mode, early and late in a sample: the step over a part */
    double *blocks;   /* of each mode and both lengths: how often it was asked for, whether it
                         is known, the block */
    double *scratch;  /* three states */
    const int *lates; /* which of the last commanded forces acts in a part */
    int size, commands, command, feed, acceleration, ungrown, growth, one;
    int parts, n_lines, entries;
};

struct mode {
    int table, motor, line;
};

/* Where a motion stands: the time since the sample and since its begin; how long it has been near
 * even motion; and when its speed was last away from the feed by more than `band`, relative. */
struct motion {
    double *state;
    double offset, passed, near, off, band;
    struct mode mode;
};

/* A motion on its way, and how it is followed: motion.py. */
struct walk {
    struct motion motion;
    double left, end, slips, rests, feed, beside, least, settles;
    int extremes, rebased, rising, turned, turns, most;
};

/* An event of the table; `least` is the speed that the slip before a stop would have fallen to. */
struct row {
    double event, time, place, speed, least, table, motor, line;
};

/* A number that is above 0 until its event comes: its value, and how it changes [1/s]. */
struct margin {
    enum event event;
    double value, slope;
};

typedef double plant_rates[PLANT][WIDTH];

STICKSLIP_EXPORT size_t stickslip_walk(const struct axis *axis, struct walk *walk,
                                       struct row rows[], size_t count);
STICKSLIP_EXPORT void stickslip_over_sample(const struct axis *axis, const struct mode *mode,
                                            int controlled, double states[], size_t count);

static void rates_of(const struct axis *axis, struct mode mode, plant_rates rates)
{
    memset(rates, 0, sizeof(plant_rates));
    if (axis->lag > 0.0) {
        rates[FORCE][FORCE] = -1.0 / axis->lag;
        rates[FORCE][PUSH] = 1.0 / axis->lag;
    }
    if (mode.motor) {
        double *force = rates[MOTOR_SPEED];
        rates[MOTOR][MOTOR_SPEED] = 1.0;
        force[axis->lag > 0.0 ? FORCE : PUSH] = 1.0 / axis->inertia;
        force[MOTOR] = -axis->k / axis->inertia;
        force[TABLE] = axis->k / axis->inertia;
        force[MOTOR_SPEED] = -axis->d / axis->inertia;
        force[ONE] = -mode.motor * axis->dry / axis->inertia;
    }
    if (mode.table) {
        const struct line *line = &axis->lines[mode.line];
        double *force = rates[SPEED];
        rates[TABLE][SPEED] = 1.0;
        force[MOTOR] = axis->k / axis->m;
        force[TABLE] = -axis->k / axis->m;
        force[SPEED] = (-axis->c - line->slope) / axis->m;
        force[ONE] = (axis->along - mode.table * (line->force - line->slope * line->low)) / axis->m;
    }
}

/* The plant's state after some time: step = exp(rates time), by its series on 2^-halved of the
 * time, squared as often. */
static void exponential(plant_rates rates, double time, plant_rates step)
{
    double norm = 0.0;
    for (int row = 0; row < PLANT; row++) {
        double sum = 0.0;
        for (int column = 0; column < PLANT; column++)
            sum += fabs(rates[row][column]);
        norm = fmax(norm, sum * time);
    }
    int halved = 0;
    for (; norm > 0.5; norm *= 0.5)
        halved++;
    time = ldexp(time, -halved);
    plant_rates term;
    for (int row = 0; row < PLANT; row++)
        for (int column = 0; column < WIDTH; column++)
            step[row][column] = term[row][column] = rates[row][column] * time;
    for (int order = 2; order < TERMS; order++) {
        plant_rates next;
        for (int row = 0; row < PLANT; row++)
            for (int column = 0; column < WIDTH; column++) {
                double sum = 0.0;
                for (int inner = 0; inner < PLANT; inner++)
                    sum += rates[row][inner] * term[inner][column];
                next[row][column] = sum * time / order;
                step[row][column] += next[row][column];
            }
        memcpy(term, next, sizeof next);
    }
    /* exp(2 A) - 1 = 2 (exp(A) - 1) + (exp(A) - 1)^2, without the loss of small numbers beside 1 */
    for (; halved > 0; halved--) {
        memcpy(term, step, sizeof term);
        for (int row = 0; row < PLANT; row++)
            for (int column = 0; column < WIDTH; column++) {
                double sum = 2.0 * term[row][column];
                for (int inner = 0; inner < PLANT; inner++)
                    sum += term[row][inner] * term[inner][column];
                step[row][column] = sum;
            }
    }
}

/* Add what a step makes of the plant under a commanded force. */
static void add_product(plant_rates step, const double state[], double push, double one,
                        double sum[PLANT])
{
    for (int row = 0; row < PLANT; row++) {
        double total = step[row][PUSH] * push + step[row][ONE] * one;
        for (int column = 0; column < PLANT; column++)
            total += step[row][column] * state[column];
        sum[row] += total;
    }
}

/* How the plant changes [1/s], under a commanded force. */
static void changes_of(plant_rates rates, const double state[], double push, double one,
                       double change[PLANT])
{
    const double stretch = state[MOTOR] - state[TABLE];
    const double *of_motor = rates[MOTOR_SPEED], *of_table = rates[SPEED];
    change[MOTOR] = rates[MOTOR][MOTOR_SPEED] * state[MOTOR_SPEED];
    change[MOTOR_SPEED] = of_motor[MOTOR] * stretch + of_motor[MOTOR_SPEED] * state[MOTOR_SPEED] +
                          of_motor[FORCE] * state[FORCE] + of_motor[PUSH] * push +
                          of_motor[ONE] * one;
    change[TABLE] = rates[TABLE][SPEED] * state[SPEED];
    change[SPEED] =
        of_table[MOTOR] * stretch + of_table[SPEED] * state[SPEED] + of_table[ONE] * one;
    change[FORCE] = rates[FORCE][FORCE] * state[FORCE] + rates[FORCE][PUSH] * push;
}

static double push_in(const struct axis *axis, const double state[], int part)
{
    return state[axis->commands + axis->lates[part]];
}

/* Move what is beside the plant over a part of a sample; `decays` are of static friction's growth. */
static void move_rest(const struct axis *axis, struct mode mode, double length, double state[],
                      const double *decays)
{
    state[axis->command] += length * (state[axis->feed] + 0.5 * length * state[axis->acceleration]);
    state[axis->feed] += length * state[axis->acceleration];
    if (mode.table == 0)
        for (int number = 0; number < axis->growth; number++)
            state[axis->ungrown + number] *=
                decays ? decays[number] : exp(-axis->rates[number] * length);
}

/* Move a state over a piece of a part: by the series for its own motion, which is short beside that
 * of the plant but for a quick current loop. */
static void move_piece(const struct axis *axis, struct mode mode, plant_rates rates, int part,
                       double length, double state[])
{
    double change[PLANT] = {0.0}, term[PLANT];
    if (axis->lag > 0.0 && length > axis->lag) {
        plant_rates step;
        exponential(rates, length, step);
        add_product(step, state, push_in(axis, state, part), state[axis->one], change);
    } else {
        changes_of(rates, state, push_in(axis, state, part), state[axis->one], term);
        for (int order = 1, more = 1; more && order < TERMS_OF_STATE; order++) {
            double next[PLANT];
            more = 0;
            for (int place = 0; place < PLANT; place++) {
                const double before = change[place];
                term[place] *= length / order;
                change[place] += term[place];
                more |= change[place] != before;
            }
            changes_of(rates, term, 0.0, 0.0, next);
            memcpy(term, next, sizeof term);
        }
    }
    for (int place = 0; place < PLANT; place++)
        state[place] += change[place];
    move_rest(axis, mode, length, state, NULL);
}

/* The step of the plant over a whole part, computed once a mode. */
static double (*step_over(const struct axis *axis, struct mode mode, int part))[WIDTH]
{
    const int late = axis->lates[part] != axis->lates[axis->parts - 1];
    const int number = ((mode.table + 1) * 3 + mode.motor + 1) * axis->n_lines + mode.line;
    double *known = axis->steps + (size_t)(2 * number + late) * (PLANT * WIDTH + 1);
    double(*step)[WIDTH] = (double(*)[WIDTH])(known + 1);
    if (known[0] == 0.0) {
        plant_rates rates;
        rates_of(axis, mode, rates);
        exponential(rates, axis->lengths[part], step);
        known[0] = 1.0;
    }
    return step;
}

static const double *decays_over(const struct axis *axis, int part)
{
    const int late = axis->lates[part] != axis->lates[axis->parts - 1];
    return axis->decays + late * axis->growth;
}

/* Move a state over a whole part of a sample. */
static void move_part(const struct axis *axis, struct mode mode, int part, double state[])
{
    double change[PLANT] = {0.0};
    add_product(step_over(axis, mode, part), state, push_in(axis, state, part), state[axis->one],
                change);
    for (int place = 0; place < PLANT; place++)
        state[place] += change[place];
    move_rest(axis, mode, axis->lengths[part], state, decays_over(axis, part));
}

/* Let the controller have its turn. */
static void control(const struct axis *axis, double state[])
{
    double *made = axis->scratch;
    memcpy(made, state, (size_t)axis->size * sizeof *made);
    for (int number = 0; number < axis->entries;) {
        const int row = axis->control[number].row;
        double sum = 0.0;
        for (; number < axis->entries && axis->control[number].row == row; number++)
            sum += axis->control[number].value * state[axis->control[number].column];
        made[row] = sum;
    }
    memcpy(state, made, (size_t)axis->size * sizeof *made);
}

/* What is left before the events of a mode; `extreme` is PEAK, DIP, or TIME for none. */
static int margins_of(const struct axis *axis, struct mode mode, enum event extreme,
                      int extreme_alone, plant_rates rates, const double state[], int part,
                      struct margin margins[MOST_MARGINS])
{
    const double push = push_in(axis, state, part), one = state[axis->one];
    double change[PLANT];
    changes_of(rates, state, push, one, change);
    const double pull = axis->k * (state[MOTOR] - state[TABLE]);
    const double pull_change = axis->k * (change[MOTOR] - change[TABLE]);
    int count = 0;
    if (extreme_alone) {
    } else if (mode.table) {
        const struct line *line = &axis->lines[mode.line];
        const double speed = mode.table * state[SPEED], change_of = mode.table * change[SPEED];
        margins[count++] = mode.line == 0
                               ? (struct margin){STOP, speed, change_of}
                               : (struct margin){SLOWER, speed - line->low * one, change_of};
        if (line->high < HUGE_VAL)
            margins[count++] = (struct margin){FASTER, line->high * one - speed, -change_of};
    } else {
        double held = axis->fully * one, grows = 0.0;
        for (int number = 0; number < axis->growth; number++) {
            const double lacks = axis->forces[number] * state[axis->ungrown + number];
            held -= lacks;
            grows += axis->rates[number] * lacks;
        }
        const double pushed = pull + axis->along * one;
        margins[count++] = (struct margin){FORWARD, held - pushed, grows - pull_change};
        margins[count++] = (struct margin){BACKWARD, held + pushed, grows + pull_change};
    }
    if (!extreme_alone && axis->dry > 0.0) {
        if (mode.motor) {
            margins[count++] = (struct margin){MOTOR_STOPS, mode.motor * state[MOTOR_SPEED],
                                               mode.motor * change[MOTOR_SPEED]};
        } else {
            const double held = axis->dry * one;
            const double pushed = (axis->lag > 0.0 ? state[FORCE] : push) - pull;
            const double change_of = (axis->lag > 0.0 ? change[FORCE] : 0.0) - pull_change;
            margins[count++] = (struct margin){MOTOR_FORWARD, held - pushed, -change_of};
            margins[count++] = (struct margin){MOTOR_BACKWARD, held + pushed, change_of};
        }
    }
    if (extreme != TIME) {
        const double slope = rates[SPEED][MOTOR] * (change[MOTOR] - change[TABLE]) +
                             rates[SPEED][SPEED] * change[SPEED];
        const double sign = extreme == PEAK ? 1.0 : -1.0;
        margins[count++] = (struct margin){extreme, sign * change[SPEED], sign * slope};
    }
    return count;
}

/* A cubic on 0 to 1 over its way from 0: divided by it where it begins at 0. */
static double cubic(double v0, double a1, double a2, double a3, double s)
{
    const double rest = a1 + s * (a2 + s * a3);
    return v0 > 0.0 ? v0 + s * rest : rest;
}

/* When a margin falls to 0 within a part, by value and slope at its ends; or infinity. */
static double crossing(struct margin begin, struct margin end, double length)
{
    const double v0 = begin.value, d0 = begin.slope, v1 = end.value, d1 = end.slope;
    if (v0 < 0.0)
        /* Another commanded force has moved it there at once. */
        return 0.0;
    if (v1 > 0.0 && !(d0 < 0.0 && 0.0 < d1 && v0 > 0.0))
        return HUGE_VAL;
    if (v0 <= 0.0 && d0 <= 0.0)
        return 0.0;
    const double a1 = length * d0;
    const double a2 = 3.0 * (v1 - v0) - length * (2.0 * d0 + d1);
    const double a3 = 2.0 * (v0 - v1) + length * (d0 + d1);
    double high = 1.0, low = 0.0;
    if (v1 > 0.0) {
        /* The least value lies where the slope of the cubic comes up through 0. */
        high = -a1 / (a2 + sqrt(fmax(a2 * a2 - 3.0 * a1 * a3, 0.0)));
        if (!(0.0 < high && high < 1.0) || cubic(v0, a1, a2, a3, high) > 0.0)
            return HUGE_VAL;
    } else if (cubic(v0, a1, a2, a3, 1.0) >= 0.0) {
        return length;
    }
    /* Newton's steps, halved where they leave the bracket. */
    double at = 0.5 * high;
    for (int step = 0; step < 100 && high - low > 1e-15; step++) {
        const double value = cubic(v0, a1, a2, a3, at);
        if (value > 0.0)
            low = at;
        else
            high = at;
        const double slope = v0 > 0.0 ? a1 + at * (2.0 * a2 + 3.0 * at * a3) : a2 + 2.0 * at * a3;
        const double next = at - value / slope;
        const double inside = next > low && next < high ? next : 0.5 * (low + high);
        if (value == 0.0 || fabs(inside - at) <= 1e-16)
            break;
        at = inside;
    }
    return length * at;
}

/* What tells whether an event can come: the speed of the table, or the stretch of the spring; the
 * speed of the motor, or the force on it at rest; the acceleration of the table. */
static void see(const struct axis *axis, struct mode mode, const double state[], double seen[SEEN])
{
    plant_rates rates;
    double change[PLANT];
    rates_of(axis, mode, rates);
    changes_of(rates, state, 0.0, state[axis->one], change);
    const double stretch = state[MOTOR] - state[TABLE];
    const double force = axis->lag > 0.0 ? state[FORCE] : push_in(axis, state, axis->parts - 1);
    seen[0] = mode.table ? state[SPEED] : stretch;
    seen[1] = mode.motor ? state[MOTOR_SPEED] : force - axis->k * stretch;
    seen[2] = change[SPEED];
}

/* What a block of so many samples makes of a state, [column][place], and what is seen at the ends
 * of its samples, [what][column][end]; NULL as long as it would not pay. */
static const double *block_of(const struct axis *axis, struct mode mode, size_t samples)
{
    const size_t size = (size_t)axis->size, ends = samples + 1;
    const int slip = mode.table ? 1 + 2 * mode.line + (mode.table > 0) : 0;
    const size_t number = (size_t)(3 * slip + mode.motor + 1);
    const size_t length = 2 + size * (size + SEEN * (SHORT + 1));
    double *known = axis->blocks + number * (2 * length + size * SEEN * (LONG - SHORT));
    known += samples == LONG ? length : 0;
    double *block = known + 2;
    if (known[1] == 0.0) {
        if (known[0]++ < OFTEN)
            return NULL;
        known[1] = 1.0;
        for (size_t column = 0; column < size; column++) {
            double *state = block + column * size, seen[SEEN];
            memset(state, 0, size * sizeof *state);
            state[column] = 1.0;
            for (size_t end = 0; end < ends; end++) {
                if (end > 0)
                    stickslip_over_sample(axis, &mode, 1, state, 1);
                see(axis, mode, state, seen);
                for (size_t what = 0; what < SEEN; what++)
                    block[size * (size + what * ends) + column * ends + end] = seen[what];
            }
        }
    }
    return block;
}

struct range {
    double low, high, change; /* over a block, and the most from sample to sample */
};

/* The range of something that is seen, and its values at the ends of the samples. */
static inline struct range range_of(const double *block, size_t size, size_t samples, size_t what,
                             const double state[], double values[])
{
    const size_t ends = samples + 1;
    const double *seen = block + size * (size + what * ends);
    memset(values, 0, ends * sizeof *values);
    for (size_t column = 0; column < size; column++)
        for (size_t end = 0; end < ends; end++)
            values[end] += seen[column * ends + end] * state[column];
    struct range range = {values[0], values[0], 0.0};
    for (size_t end = 1; end < ends; end++) {
        const double value = values[end], change = fabs(value - values[end - 1]);
        range.low = value < range.low ? value : range.low;
        range.high = value > range.high ? value : range.high;
        range.change = change > range.change ? change : range.change;
    }
    return range;
}

/* Whether what is seen stays above a limit, by twice what it changes from sample to sample; of its
 * negative, with a sign below 0. */
static int stays_above(struct range range, double sign, double limit)
{
    return (sign > 0.0 ? range.low : -range.high) - limit > 2.0 * range.change;
}

/* Pass a block of samples; 0 and nothing if an event may come. For static friction that of the
 * beginning is taken, as it only grows. */
static inline int pass_block(const struct axis *axis, struct motion *motion, enum event extreme,
                      size_t samples, double elapsed)
{
    const struct mode mode = motion->mode;
    const double *block = block_of(axis, mode, samples), *state = motion->state;
    const double one = state[axis->one], feed = state[axis->feed];
    const size_t size = (size_t)axis->size;
    double values[LONG + 1], off = -1.0;
    if (block == NULL)
        return 0;
    const struct range seen = range_of(block, size, samples, 0, state, values);
    const double away = fmax(seen.high - feed, feed - seen.low);
    const int even = mode.table > 0 && state[axis->acceleration] == 0.0 && away < EVEN * feed;
    if (!even)
        motion->near = 0.0;
    if (mode.table) {
        const struct line *line = &axis->lines[mode.line];
        if (!stays_above(seen, mode.table, line->low * one) ||
            !stays_above(seen, -mode.table, -line->high * one))
            return 0;
        for (size_t end = 0; end <= samples; end++)
            if (fabs(values[end] - feed) > motion->band * feed)
                off = (double)end * axis->sample;
        if (extreme != TIME && !(even && away < STILL * feed) &&
            !stays_above(range_of(block, size, samples, 2, state, values),
                         extreme == PEAK ? 1.0 : -1.0, 0.0))
            return 0;
    } else {
        double held = axis->fully * one;
        for (int number = 0; number < axis->growth; number++)
            held -= axis->forces[number] * state[axis->ungrown + number];
        if (!stays_above(seen, -1.0, (axis->along * one - held) / axis->k) ||
            !stays_above(seen, 1.0, -(held + axis->along * one) / axis->k))
            return 0;
    }
    if (axis->dry > 0.0) {
        const struct range motor = range_of(block, size, samples, 1, state, values);
        if (mode.motor ? !stays_above(motor, mode.motor, 0.0)
                       : !stays_above(motor, 1.0, -axis->dry * one) ||
                             !stays_above(motor, -1.0, -axis->dry * one))
            return 0;
    }
    double *next = axis->scratch;
    memset(next, 0, size * sizeof *next);
    for (size_t column = 0; column < size; column++)
        for (size_t place = 0; place < size; place++)
            next[place] += block[column * size + place] * state[column];
    memcpy(motion->state, next, size * sizeof *next);
    if (even)
        motion->near += (double)samples * axis->sample;
    if (mode.table && off >= 0.0)
        motion->off = motion->passed + elapsed + off;
    return 1;
}

/* Follow a motion in its mode to the first event, at most for some time [s]; the time that it took.
 * A margin that is 0 at the beginning is watched from when it is above. Motion that stays near even
 * motion for the time `settles` [s] has no events. */
static enum event follow(const struct axis *axis, struct motion *motion, enum event extreme,
                         int extreme_alone, double until, double settles, double *elapsed)
{
    const struct mode mode = motion->mode;
    double *state = motion->state, *offset = &motion->offset;
    const int blocks = !extreme_alone && axis->parts <= FEW_PARTS;
    int stay = 0, row = 0;
    double push = NAN;
    struct margin begin[MOST_MARGINS], end[MOST_MARGINS] = {{TIME, 0.0, 0.0}};
    plant_rates rates;
    rates_of(axis, mode, rates);
    *elapsed = 0.0;
    for (;;) {
        if (*offset == 0.0) {
            while (blocks && stay == 0) {
                const size_t samples = row < LONG / SHORT ? SHORT : LONG;
                const double block = (double)samples * axis->sample;
                if (until - *elapsed > block &&
                    (samples == SHORT ? pass_block(axis, motion, extreme, SHORT, *elapsed)
                                      : pass_block(axis, motion, extreme, LONG, *elapsed))) {
                    push = NAN;
                    row++;
                    *elapsed += block;
                    if (motion->near > settles) {
                        *elapsed = until;
                        return TIME;
                    }
                } else {
                    stay = samples == SHORT ? SHORT : 0;
                    row = 0;
                }
            }
            stay -= stay > 0;
            if (until - *elapsed <= NONE * axis->sample)
                return TIME;
            control(axis, state);
        }
        for (int part = 0; part < axis->parts; part++) {
            const double left = axis->offsets[part + 1] - *offset;
            if (left <= NONE * axis->sample)
                continue;
            const double length = fmin(left, until - *elapsed);
            const int whole = *offset == axis->offsets[part] && length == left;
            double *next = axis->scratch + axis->size;
            memcpy(next, state, (size_t)axis->size * sizeof *next);
            /* The end of the part before, unless the commanded force has changed. */
            if (push_in(axis, state, part) == push)
                memcpy(begin, end, sizeof begin);
            else
                margins_of(axis, mode, extreme, extreme_alone, rates, state, part, begin);
            push = push_in(axis, state, part);
            if (whole)
                move_part(axis, mode, part, next);
            else
                move_piece(axis, mode, rates, part, length, next);
            const int count =
                margins_of(axis, mode, extreme, extreme_alone, rates, next, part, end);
            double first = HUGE_VAL;
            enum event event = TIME;
            for (int number = 0; number < count; number++) {
                const double after = crossing(begin[number], end[number], length);
                if (after < first) {
                    first = after;
                    event = begin[number].event;
                }
            }
            if (event != TIME) {
                move_piece(axis, mode, rates, part, first, state);
                *offset += first;
                *elapsed += first;
                return event;
            }
            memcpy(state, next, (size_t)axis->size * sizeof *next);
            *offset += length;
            *elapsed += length;
            const double feed = state[axis->feed];
            if (mode.table && fabs(state[SPEED] - feed) > motion->band * feed)
                motion->off = motion->passed + *elapsed;
            if (*elapsed >= until)
                return TIME;
        }
        *offset = 0.0;
        if (*elapsed >= until)
            return TIME;
    }
}

static int direction(double force)
{
    return force > 0.0 ? 1 : -1;
}

/* Go on after an event: the mode, and what stands at rest. */
static void pass(const struct axis *axis, enum event event, double state[], double offset,
                 struct mode *mode)
{
    const double pull = axis->k * (state[MOTOR] - state[TABLE]);
    if (event == STOP) {
        double holds = axis->fully;
        state[SPEED] = 0.0;
        for (int number = 0; number < axis->growth; number++) {
            state[axis->ungrown + number] = 1.0;
            holds -= axis->forces[number];
        }
        const double pushed = pull + axis->along;
        mode->table = fabs(pushed) <= holds ? 0 : direction(pushed);
    } else if (event == SLOWER || event == FASTER) {
        const struct line *line = &axis->lines[mode->line];
        state[SPEED] = mode->table * (event == FASTER ? line->high : line->low);
        mode->line += event == FASTER ? 1 : -1;
    } else if (event == FORWARD || event == BACKWARD) {
        mode->table = event == FORWARD ? 1 : -1;
    } else if (event == MOTOR_STOPS) {
        int part = 0;
        while (part < axis->parts - 1 && axis->offsets[part + 1] <= offset)
            part++;
        state[MOTOR_SPEED] = 0.0;
        const double force = axis->lag > 0.0 ? state[FORCE] : push_in(axis, state, part);
        mode->motor = fabs(force - pull) <= axis->dry ? 0 : direction(force - pull);
    } else if (event == MOTOR_FORWARD || event == MOTOR_BACKWARD) {
        mode->motor = event == MOTOR_FORWARD ? 1 : -1;
    }
}

/* The speed that a slip which has come to 0 would fall to without rest, sought within a time. */
static double least_speed(const struct axis *axis, struct motion motion, double time)
{
    double *state = axis->scratch + 2 * axis->size, elapsed;
    memcpy(state, motion.state, (size_t)axis->size * sizeof *state);
    motion.state = state;
    follow(axis, &motion, DIP, 1, time, HUGE_VAL, &elapsed);
    return state[SPEED];
}

size_t stickslip_walk(const struct axis *axis, struct walk *walk, struct row rows[], size_t count)
{
    struct motion *const motion = &walk->motion;
    double *const state = motion->state;
    size_t written = 0;
    while (written < count && walk->turns < walk->most) {
        double elapsed, until = fmin(walk->left, walk->end), least = NAN;
        enum event extreme = TIME;
        if (walk->turned)
            /* Beside an extreme its own rounding would be the next one. */
            until = fmin(until, walk->beside);
        else if (walk->extremes && motion->mode.table)
            extreme = walk->rising ? PEAK : DIP;
        const enum event event =
            follow(axis, motion, extreme, 0, until, walk->settles, &elapsed);
        walk->turns++;
        motion->passed += elapsed;
        walk->left -= elapsed;
        walk->end -= elapsed;
        if (event == TIME && walk->left <= 0.0) {
            state[axis->feed] = walk->feed;
            state[axis->acceleration] = 0.0;
            walk->left = HUGE_VAL;
            continue;
        }
        if (event == TIME && walk->end <= 0.0)
            break;
        if (event == STOP && walk->least > 0.0)
            least = least_speed(axis, *motion, walk->least);
        const int before = motion->mode.table;
        pass(axis, event, state, motion->offset, &motion->mode);
        walk->turned = event == PEAK || event == DIP;
        if (walk->turned) {
            walk->rising = !walk->rising;
        } else if (motion->mode.table != before) {
            walk->rising = motion->mode.table > 0;
            motion->near = 0.0;
            walk->end = fmax(walk->end, motion->mode.table ? walk->slips : walk->rests);
        } else {
            continue;
        }
        rows[written++] =
            (struct row){event, motion->passed,     state[TABLE],       state[SPEED],
                         least, motion->mode.table, motion->mode.motor, motion->mode.line};
        if (event == STOP && walk->rebased) {
            const double place = state[TABLE];
            state[MOTOR] -= place;
            state[TABLE] -= place;
            state[LAST] -= place;
            state[axis->command] -= place;
        }
    }
    return written;
}

void stickslip_over_sample(const struct axis *axis, const struct mode *mode, int controlled,
                           double states[], size_t count)
{
    for (size_t number = 0; number < count; number++) {
        double *state = states + number * (size_t)axis->size;
        if (controlled)
            control(axis, state);
        for (int part = 0; part < axis->parts; part++)
            move_part(axis, *mode, part, state);
    }
}
