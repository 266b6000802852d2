/* With the responses G, K of the oscillator, the integral H of G, and the net force R:
 *
 *     x_dot = x_dot_start K' + v G + R/m K
 *     x - x_start = x_dot_start K + v H + R/k G
 *     z - z_start = (v - x_dot_start) K - (R - c v)/k G
 */
#include "coulomb_slip.h"

#include <math.h>

static const double PI = 3.141592653589793;

/* The heat of damping has a closed form, of differences that cancel while the motion has hardly
 * begun. Up to this multiple of the shortest time, and in heavy damping up to this fraction of the
 * longest one, it is integrated instead. */
static const double SHORT = 4.0;
static const double EARLY = 1e-2;

/* An interval in time [s]. */
struct interval {
    double low, high;
};

static double velocity(const struct arc *arc, struct responses at)
{
    const struct coulomb_slip *slip = &arc->of.coulomb;
    return arc->x_dot_start * at.slope + slip->v * at.step + slip->push * at.impulse;
}

static double acceleration(const struct coulomb_slip *slip, struct responses at)
{
    return slip->acceleration * at.slope + slip->fade * at.impulse;
}

void coulomb_slip_speed(const void *context, double tau, double *value, double *slope)
{
    const struct arc *arc = context;
    const struct responses at = oscillator_responses(&arc->of.coulomb.oscillator, tau);
    *value = arc->mode * velocity(arc, at);
    *slope = arc->mode * acceleration(&arc->of.coulomb, at);
}

/* The square of the speed [m2/s2]; a `graph`, of an arc, but without slope. */
static void squared_speed(const void *context, double tau, double *value, double *slope)
{
    double speed;
    coulomb_slip_speed(context, tau, &speed, slope);
    *value = speed * speed;
}

static double speed_at(const struct arc *arc, double tau)
{
    double value, slope;
    coulomb_slip_speed(arc, tau, &value, &slope);
    return value;
}

/* The interval in which the speed falls to its first minimum, for a < w: (5).
 *
 * The acceleration is a damped sine: it first turns from falling to rising speed a quarter turn
 * before the phase of its own maximum. */
static struct interval enclose_swinging(struct arc *arc)
{
    struct coulomb_slip *slip = &arc->of.coulomb;
    const double a = slip->oscillator.a, b = slip->oscillator.b;
    const double of_sine = slip->fade - a * slip->acceleration;
    const double phase = atan2(arc->mode * of_sine, arc->mode * slip->acceleration * b);
    double lowest = phase - 0.5 * PI;
    if (lowest <= 0.0) lowest += 2.0 * PI;
    const double highest = lowest - PI;
    if (highest < 0.0) {
        /* The speed falls from the start, so the maximum that counts lies behind the minimum. */
        slip->peak_time = (highest + 2.0 * PI) / b;
        return (struct interval){0.0, lowest / b};
    }
    slip->peak_time = highest / b;
    return (struct interval){slip->peak_time, lowest / b};
}

double coulomb_slip_turning_time(const struct arc *arc)
{
    const struct coulomb_slip *slip = &arc->of.coulomb;
    const double slow = slip->oscillator.slow, fast = slip->oscillator.fast;
    const double apart = 2.0 * slip->oscillator.b;
    const double lead = slow * (slip->push - slow * arc->x_dot_start - fast * slip->v);
    if (lead == 0.0) return HUGE_VAL;
    const double ratio = slip->acceleration / lead;
    if (ratio <= 0.0) return HUGE_VAL;
    return apart > 0.0 ? log1p(apart * ratio) / apart : ratio;
}

/* An interval in which the speed falls through zero, for a >= w.
 *
 * There is one extreme at most, and the speed ends at that of the pulling end. */
static struct interval enclose_decaying(struct arc *arc)
{
    struct coulomb_slip *slip = &arc->of.coulomb;
    const double start = arc->mode * slip->acceleration;
    const double turn = coulomb_slip_turning_time(arc);
    double low = 0.0;
    if (start > 0.0 || (start == 0.0 && arc->mode * slip->fade > 0.0)) {
        slip->peak_time = turn;
        low = turn;
    } else if (turn < HUGE_VAL) {
        return (struct interval){0.0, turn};
    }
    if (low == HUGE_VAL || arc->mode * slip->v >= 0.0) return (struct interval){0.0, HUGE_VAL};
    double reach = 1.0 / slip->oscillator.w;
    while (low + reach < HUGE_VAL && speed_at(arc, low + reach) > 0.0) reach *= 2.0;
    return (struct interval){low, low + reach};
}

double coulomb_slip_find_end(struct arc *arc)
{
    const struct coulomb_slip *slip = &arc->of.coulomb;
    if (arc->x_dot_start == 0.0 && arc->mode * slip->acceleration < 0.0) return 0.0;
    const struct interval found =
        slip->oscillator.overdamped ? enclose_decaying(arc) : enclose_swinging(arc);
    if (slip->from_rest) {
        const double w = slip->oscillator.w;
        return 2.0 * atan2(w * fabs(slip->swing), -arc->mode * slip->v) / w;
    }
    if (found.high == HUGE_VAL || speed_at(arc, found.high) > 0.0) return HUGE_VAL;
    return falling_zero(coulomb_slip_speed, arc, found.low, found.high);
}

void coulomb_slip_begin(const struct oscillator *oscillator, double v, double z, double x_dot,
                        int mode, double net, double kinetic, struct arc *made)
{
    struct coulomb_slip slip = {.oscillator = *oscillator, .v = v, .kinetic = kinetic, .net = net};
    const double k = oscillator->k, m = oscillator->m, c = oscillator->c;
    slip.z_dot = v - x_dot;
    slip.push = net / m;
    slip.acceleration = (net - c * x_dot) / m;
    slip.reach = net / k;
    /* Distance of the spring from the centre of its swing. */
    slip.swing = (net - c * v) / k;
    /* Factor of K in the acceleration, whose factor of K' is that at the start. */
    slip.fade = oscillator->w2 * slip.z_dot;
    /* An undamped slip from rest to rest has its own closed form. */
    slip.from_rest = x_dot == 0.0 && c == 0.0 && mode * slip.acceleration >= 0.0;
    slip.peak_time = HUGE_VAL;
    *made = (struct arc){.tag = COULOMB_SLIP,
                         .mode = mode,
                         .z_start = z,
                         .x_dot_start = x_dot,
                         .of.coulomb = slip};
}

void coulomb_slip_make(const struct oscillator *oscillator, double v, double z, double x_dot,
                       int mode, double net, double kinetic, struct arc *made)
{
    coulomb_slip_begin(oscillator, v, z, x_dot, mode, net, kinetic, made);
    made->duration = coulomb_slip_find_end(made);
}

void coulomb_slip_start(const struct arc *arc, struct start *start)
{
    *start = (struct start){.mode = arc->mode,
                            .known = true,
                            .z = arc->z_start,
                            .x_dot = arc->x_dot_start,
                            .force = arc->of.coulomb.net};
}

struct motion coulomb_slip_state(const struct arc *arc, double tau)
{
    const struct coulomb_slip *slip = &arc->of.coulomb;
    const struct oscillator *oscillator = &slip->oscillator;
    const struct responses at = oscillator_responses(oscillator, tau);
    const double start = arc->x_dot_start, v = slip->v;
    double x_dot = start * at.slope + v * at.step + slip->push * at.impulse;
    /* Rounding beside an end of the slip; the motion itself never turns. */
    if (x_dot * arc->mode < 0.0) x_dot = 0.0;
    const double integral = oscillator_step_integral(oscillator, tau, at);
    return (struct motion){
        .growth = slip->z_dot * at.impulse - slip->swing * at.step,
        .x_dot = x_dot,
        .displacement = start * at.impulse + v * integral + slip->reach * at.step,
        .friction = -(arc->mode * slip->kinetic + oscillator->c * x_dot),
    };
}

struct motion coulomb_slip_end(const struct arc *arc)
{
    const struct coulomb_slip *slip = &arc->of.coulomb;
    struct motion end = coulomb_slip_state(arc, arc->duration);
    end.x_dot = 0.0;
    if (slip->from_rest) {
        end.growth = -2.0 * slip->swing;
        if (arc->mode * slip->v > 0.0)
            end.displacement = slip->v * arc->duration - end.growth;
    }
    return end;
}

double coulomb_slip_way_to_break_away(const struct arc *arc, double gap)
{
    const struct coulomb_slip *slip = &arc->of.coulomb;
    if (slip->from_rest) return gap + arc->mode * slip->net;
    /* From the acceleration at the stop. */
    const struct responses at = oscillator_responses(&slip->oscillator, arc->duration);
    return gap - arc->mode * slip->oscillator.m * acceleration(slip, at);
}

/* (11). Of all maxima the first is the highest, for damping only takes from them. */
double coulomb_slip_extreme_velocity(const struct arc *arc, double tau)
{
    double extreme = arc->x_dot_start;
    const double now = coulomb_slip_state(arc, tau).x_dot;
    if (fabs(now) > fabs(extreme)) extreme = now;
    if (arc->of.coulomb.peak_time < tau) {
        const double peak = coulomb_slip_state(arc, arc->of.coulomb.peak_time).x_dot;
        if (fabs(peak) > fabs(extreme)) extreme = peak;
    }
    return extreme;
}

/* (15) */
double coulomb_slip_pull_work(const struct arc *arc, double tau)
{
    const struct coulomb_slip *slip = &arc->of.coulomb;
    const struct oscillator *oscillator = &slip->oscillator;
    const struct responses at = oscillator_responses(oscillator, tau);
    const double integral = oscillator_step_integral(oscillator, tau, at);
    const double growth = slip->z_dot * at.step / oscillator->w2 - slip->swing * integral;
    return oscillator->k * slip->v * (arc->z_start * tau + growth);
}

/* The integral of x_dot^2 up to tau [m2/s], for the displacement there [m]: (15). */
static double squared_velocity(const struct arc *arc, double tau, double displacement)
{
    const struct coulomb_slip *slip = &arc->of.coulomb;
    const struct oscillator *oscillator = &slip->oscillator;
    double end = SHORT / oscillator->quickest;
    if (tau <= end) return integral(squared_speed, arc, 0.0, tau);
    if (oscillator->overdamped && oscillator->slow * tau < EARLY) {
        double total = integral(squared_speed, arc, 0.0, end);
        while (end < tau) {
            const double start = end;
            end = 2.0 * end < tau ? 2.0 * end : tau;
            total += integral(squared_speed, arc, start, end);
        }
        return total;
    }
    const double v = slip->v, z_dot = slip->z_dot, start = slip->acceleration;
    double of_rest, of_impulse;
    oscillator_squares(oscillator, tau, &of_rest, &of_impulse);
    const double step = oscillator_responses(oscillator, tau).step;
    const double mixed = step * (2.0 - step) / oscillator->w2;
    return v * (2.0 * displacement - v * tau) + z_dot * (z_dot * of_rest - start * mixed) +
           start * start * of_impulse;
}

/* (15) */
double coulomb_slip_heat(const struct arc *arc, double tau, double displacement)
{
    const struct coulomb_slip *slip = &arc->of.coulomb;
    double heat = slip->kinetic * fabs(displacement);
    if (slip->oscillator.c > 0.0)
        heat += slip->oscillator.c * squared_velocity(arc, tau, displacement);
    return heat;
}

const struct arc_functions COULOMB_SLIP_FUNCTIONS = {
    .start = coulomb_slip_start,
    .state = coulomb_slip_state,
    .end = coulomb_slip_end,
    .pull_work = coulomb_slip_pull_work,
    .heat = coulomb_slip_heat,
    .extreme_velocity = coulomb_slip_extreme_velocity,
};
