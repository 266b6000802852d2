/* Between two extremes the speed is monotone, so the first time at which it reaches an end of the
 * band is enclosed. With rho = u - s v the extremes of a swing are pi/b apart, and rho there grows
 * by -exp(-a pi/b) from one to the next. A growing motion that swings many times before it leaves
 * is taken to its last turns by the logarithm of what it lacks. */
#include "band.h"

#include "coulomb_slip.h"
#include "numerics.h"

#include <float.h>
#include <math.h>

static const double PI = 3.141592653589793;

/* Panels of the quadrature hold a growth or decay by exp(4) at most, at most so many of them. */
static const double PANEL = 4.0;
static const double MOST_PANELS = 256.0;
/* A motion that would need a growth by exp(600) to move has no digit of one. */
static const double MOST_GROWTH = 600.0;
/* A speed that passes the end of a band by rounding alone stays in the band: 2^-49. */
static const double SLACK = 1.7763568394002505e-15;
/* Half the distance from 1 to the next number above it, twice that to the one below: 2^-52. */
static const double NEXT = 2.220446049250313e-16;

/* The first of the extremes of a growing swing that may leave the band, from the estimate, and
 * their count. */
static const double TURNS_BEFORE = 2.0, TURNS_AFTER = 6.0;

static double speed_at(const struct arc *arc, double tau)
{
    double value, slope;
    coulomb_slip_speed(arc, tau, &value, &slope);
    return value;
}

/* Walks over times of extremes of the speed between which it is monotone, those that count. */
struct extremes {
    double before; /* up to here the extreme of largest magnitude is among them [s] */
    double first, half, turns, start;
    int next;
};

/* The next extreme: false after the last one. Infinity where the speed goes on without one. */
static bool next_extreme(const struct arc *arc, struct extremes *walk, double *time)
{
    const struct coulomb_slip *slip = &arc->of.coulomb;
    const struct oscillator *oscillator = &slip->oscillator;
    const struct band *band = &arc->of.band.band;
    const int step = walk->next++;
    if (oscillator->overdamped) {
        const double turn = coulomb_slip_turning_time(arc);
        *time = step == 0 && turn < HUGE_VAL ? turn : HUGE_VAL;
        return step == 0 || (step == 1 && turn < HUGE_VAL);
    }
    const double a = oscillator->a, b = oscillator->b;
    if (step == 0) {
        const double along = arc->mode * slip->acceleration;
        walk->half = PI / b;
        walk->first = atan2(-along * b, arc->mode * slip->fade - a * along) / b;
        while (walk->first <= 0.0) walk->first += walk->half;
        *time = walk->first;
        return true;
    }
    if (step == 1) {
        *time = walk->first + walk->half;
        return true;
    }
    if (step == 2) {
        const double pull = arc->mode * slip->v;
        double swing = fabs(speed_at(arc, walk->first) - pull);
        if (swing == 0.0) {
            /* Where rounding hides it beside the pull, by its own terms. */
            const struct responses at = oscillator_responses(oscillator, walk->first);
            swing = fabs(slip->acceleration * at.impulse - slip->z_dot * (1.0 - at.step));
        }
        if (a >= 0.0 || swing == 0.0) return false;
        /* Turns until the swing reaches an end of the band, whichever is nearer to the pull. */
        const double above = band->high - pull;
        double reach = pull - band->low;
        if (above < reach) reach = above;
        if (swing > reach) reach = swing;
        walk->turns = log(reach / swing) / (-a * walk->half);
        if (walk->before < HUGE_VAL) {
            const double most = (walk->before - walk->first) / walk->half;
            if (most < walk->turns) walk->turns = most;
        }
        walk->start = floor(walk->turns) - TURNS_BEFORE;
        if (!(walk->start > 2.0)) walk->start = 2.0;
    }
    const double n = walk->start + (step - 2);
    if (!(n < walk->turns + TURNS_AFTER)) return false;
    *time = walk->first + n * walk->half;
    return true;
}

/* A time up to `most` by which a monotone speed has left the band, or infinity. */
static double enclose_tail(const struct arc *arc, double low, double most)
{
    const struct band_slip *slip = &arc->of.band;
    const struct oscillator *oscillator = &slip->coulomb.oscillator;
    const double pull = arc->mode * slip->coulomb.v;
    if (oscillator->c > 0.0 && slip->floor <= pull && pull <= slip->ceiling) return HUGE_VAL;
    double reach = 1.0 / oscillator->quickest, high = low;
    while (high < most) {
        high = most < low + reach ? most : low + reach;
        const double speed = speed_at(arc, high);
        if (!(slip->floor < speed && speed <= slip->ceiling)) return high;
        reach *= 2.0;
    }
    return HUGE_VAL;
}

static void above_low(const void *context, double tau, double *value, double *slope)
{
    const struct arc *arc = context;
    coulomb_slip_speed(arc, tau, value, slope);
    *value = *value - arc->of.band.band.low;
}

static void below_high(const void *context, double tau, double *value, double *slope)
{
    const struct arc *arc = context;
    coulomb_slip_speed(arc, tau, value, slope);
    *value = arc->of.band.band.high - *value;
    *slope = -*slope;
}

/* When the speed is that of the lower end of the band, between these times. */
static double fall_to_low(struct arc *arc, double low, double high)
{
    if (arc->of.band.band.low > 0.0)
        arc->of.band.leaves = -1;
    else if (arc->of.coulomb.from_rest)
        return coulomb_slip_find_end(arc);
    arc->of.coulomb.from_rest = false;
    return falling_zero(above_low, arc, low, high);
}

/* When the mass first comes to rest or leaves the band, or infinity. */
static double find_end(struct arc *arc)
{
    const struct coulomb_slip *slip = &arc->of.coulomb;
    const double start = arc->mode * arc->x_dot_start;
    /* Where the acceleration is 0 its rate decides. */
    const double rise = arc->mode * (slip->acceleration != 0.0 ? slip->acceleration : slip->fade);
    if (start == 0.0 && arc->mode * slip->acceleration < 0.0) return 0.0;
    if (start > 0.0 && rise == 0.0) {
        arc->of.band.steady = slip->oscillator.c < 0.0;
        return HUGE_VAL;
    }
    const double growth = -slip->oscillator.slow;
    const double most = growth > 0.0 ? MOST_GROWTH / growth : DBL_MAX;
    struct extremes walk = {.before = HUGE_VAL};
    double low = 0.0, extreme;
    while (next_extreme(arc, &walk, &extreme)) {
        const double high = extreme < most ? extreme : enclose_tail(arc, low, most);
        if (high == HUGE_VAL) break;
        const double speed = speed_at(arc, high);
        if (speed <= arc->of.band.floor) return fall_to_low(arc, low, high);
        if (speed > arc->of.band.ceiling) {
            arc->of.band.leaves = 1;
            arc->of.coulomb.from_rest = false;
            return falling_zero(below_high, arc, low, high);
        }
        low = high;
    }
    return HUGE_VAL;
}

void band_slip_make(const struct oscillator *oscillator, double v, double z, double x_dot, int mode,
                    double net, double kinetic, const struct band *band, struct arc *made)
{
    const double inner = net - mode * band->rise;
    const double scale =
        fabs(v) + fabs(x_dot) + fabs(inner) / (oscillator->m * oscillator->quickest);
    coulomb_slip_begin(oscillator, v, z, x_dot, mode, inner, kinetic + band->rise, made);
    struct band_slip *slip = &made->of.band;
    made->tag = BAND_SLIP;
    slip->band = *band;
    slip->base = net;
    slip->leaves = 0;
    slip->steady = false;
    slip->floor = band->low > 0.0 ? band->low - SLACK * (band->low + scale) : 0.0;
    slip->ceiling =
        band->high < HUGE_VAL ? band->high + SLACK * (band->high + scale) : HUGE_VAL;
    made->duration = find_end(made);
}

double band_slip_exit_speed(const struct arc *ended)
{
    const struct band_slip *slip = &ended->of.band;
    if (slip->leaves > 0) return slip->band.high * (1.0 + NEXT);
    return slip->band.low * (1.0 - NEXT);
}

double band_slip_net_at_end(const struct arc *ended, double growth)
{
    return ended->of.band.base + ended->of.coulomb.oscillator.k * growth;
}

static void band_slip_start(const struct arc *arc, struct start *start)
{
    coulomb_slip_start(arc, start);
    start->force = arc->of.band.base;
}

/* Where it is exactly steady, rounding does not grow. */
static struct motion band_slip_state(const struct arc *arc, double tau)
{
    if (!arc->of.band.steady) return coulomb_slip_state(arc, tau);
    struct motion motion = coulomb_slip_state(arc, 0.0);
    motion.displacement = motion.x_dot * tau;
    return motion;
}

/* At an end or an extreme. */
static double band_slip_extreme_velocity(const struct arc *arc, double tau)
{
    double largest = arc->x_dot_start, time;
    const double last = band_slip_state(arc, tau).x_dot;
    if (fabs(last) > fabs(largest)) largest = last;
    struct extremes walk = {.before = tau};
    while (next_extreme(arc, &walk, &time)) {
        if (!(time < tau)) continue;
        const double extreme = band_slip_state(arc, time).x_dot;
        if (fabs(extreme) > fabs(largest)) largest = extreme;
    }
    return largest;
}

/* The integral of (x_dot - v)^2 up to tau [m2/s]. */
static double squared_excess(const struct coulomb_slip *slip, double tau)
{
    const struct oscillator *oscillator = &slip->oscillator;
    const double z_dot = slip->z_dot, acceleration = slip->acceleration;
    double of_rest, of_impulse;
    oscillator_squares(oscillator, tau, &of_rest, &of_impulse);
    const double step = oscillator_responses(oscillator, tau).step;
    const double mixed = step * (2.0 - step) / oscillator->w2;
    return z_dot * (z_dot * of_rest - acceleration * mixed) +
           acceleration * acceleration * of_impulse;
}

/* The power of friction and damping at tau [W]. */
static void power(const void *context, double tau, double *value, double *slope)
{
    const struct arc *arc = context;
    const struct band *band = &arc->of.band.band;
    double speed;
    coulomb_slip_speed(arc, tau, &speed, slope);
    const double viscous = arc->of.coulomb.oscillator.c - band->slope;
    *value = (band->friction + band->slope * (speed - band->low) + viscous * speed) * speed;
}

/* The heat by quadrature over panels, which grow with time in heavy damping [J]. */
static double integrated_heat(const struct arc *arc, double tau)
{
    const struct oscillator *oscillator = &arc->of.coulomb.oscillator;
    double panel = PANEL / oscillator->quickest;
    const bool grows = oscillator->overdamped && oscillator->c > 0.0;
    if (!grows && tau > MOST_PANELS * panel) panel = tau / MOST_PANELS;
    double total = 0.0, end = 0.0;
    while (end < tau) {
        const double start = end;
        end = tau < end + panel ? tau : end + panel;
        total += integral(power, arc, start, end);
        if (grows) panel = end;
    }
    return total;
}

/* (15). While the speed of the pull is in the band, the friction is counted from that at this speed:
 * f(V) way + (c + slope) (-V growth + integral of rho^2). Beyond, and while the motion has hardly
 * begun, the power is integrated. */
static double band_slip_heat(const struct arc *arc, double tau, double displacement)
{
    const struct coulomb_slip *slip = &arc->of.coulomb;
    const struct oscillator *oscillator = &slip->oscillator;
    const struct band *band = &arc->of.band.band;
    if (band->slope == 0.0) return coulomb_slip_heat(arc, tau, displacement);
    const double pull = arc->mode * slip->v;
    if (tau > PANEL / oscillator->quickest && band->low <= pull && pull <= band->high) {
        const double viscous = oscillator->c - band->slope;
        const double friction = band->friction + band->slope * (pull - band->low) + viscous * pull;
        const double way = arc->mode * displacement;
        if (oscillator->c == 0.0) return friction * way;
        if (!oscillator->overdamped || fabs(oscillator->slow) * tau > 1.0) {
            const double growth = pull * tau - way;
            return friction * way + oscillator->c * (squared_excess(slip, tau) - pull * growth);
        }
    }
    return integrated_heat(arc, tau);
}

const struct arc_functions BAND_SLIP_FUNCTIONS = {
    .start = band_slip_start,
    .state = band_slip_state,
    .end = coulomb_slip_end,
    .pull_work = coulomb_slip_pull_work,
    .heat = band_slip_heat,
    .extreme_velocity = band_slip_extreme_velocity,
};
