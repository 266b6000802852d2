/* Kinetic friction that falls linearly with speed, in closed form: tests/laws/falling/block.py. */
#include "coefficients.h"
#include "coulomb_slip.h"
#include "law.h"
#include "sticking.h"

#include <float.h>
#include <math.h>

static const double PI = 3.141592653589793;

/* Panels of the quadrature hold a growth by exp(4) at most. */
static const double PANEL = 4.0;
/* A motion that would need a growth by exp(600) to move has no digit of one. */
static const double MOST_GROWTH = 600.0;
/* Above MOST_GROWTH / PANEL. */
enum { MOST_PANELS = 256 };

static double speed_at(const struct arc *arc, double tau)
{
    double value, slope;
    coulomb_slip_speed(arc, tau, &value, &slope);
    return value;
}

static void below_limit(const void *context, double tau, double *value, double *slope)
{
    const struct arc *arc = context;
    coulomb_slip_speed(arc, tau, value, slope);
    *value = arc->of.falling.limit - *value;
    *slope = -*slope;
}

/* Walks over times of extremes of the speed between which it is monotone, those that count. */
struct extremes {
    double before, first, half, turns;
    int next, n;
};

/* The next extreme: false after the last one. Infinity where the speed goes on without one. */
static bool next_extreme(const struct arc *arc, struct extremes *walk, double *time)
{
    const struct coulomb_slip *slip = &arc->of.coulomb;
    const struct oscillator *oscillator = &slip->oscillator;
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
        const double swing = fabs(speed_at(arc, walk->first) - pull);
        if (a >= 0.0 || swing == 0.0) return false;
        /* Turns until the swing reaches standstill or the limit, whichever is nearer to the pull. */
        const double room = arc->of.falling.limit - pull;
        double reach = room < pull ? room : pull;
        if (swing > reach) reach = swing;
        walk->turns = log(reach / swing) / (-a * walk->half);
        if (walk->before < HUGE_VAL) {
            const double most = (walk->before - walk->first) / walk->half;
            if (most < walk->turns) walk->turns = most;
        }
        walk->n = (int)floor(walk->turns) - 2;
        if (walk->n < 2) walk->n = 2;
    }
    if (!(walk->n < walk->turns + 6.0)) return false;
    *time = walk->first + walk->n++ * walk->half;
    return true;
}

/* A time up to `most` by which a monotone speed has ended the slip or the law, or infinity. */
static double enclose_tail(const struct arc *arc, double low, double most)
{
    const struct coulomb_slip *slip = &arc->of.coulomb;
    const double limit = arc->of.falling.limit, pull = arc->mode * slip->v;
    if (slip->oscillator.c > 0.0 && 0.0 <= pull && pull <= limit) return HUGE_VAL;
    double reach = 1.0 / slip->oscillator.quickest, high = low;
    while (high < most) {
        high = most < low + reach ? most : low + reach;
        const double speed = speed_at(arc, high);
        if (!(0.0 < speed && speed <= limit)) return high;
        reach *= 2.0;
    }
    return HUGE_VAL;
}

/* When the mass first comes to rest or leaves the law, or infinity. */
static double find_end(struct arc *arc)
{
    const struct coulomb_slip *slip = &arc->of.coulomb;
    const double limit = arc->of.falling.limit;
    const double start = arc->mode * arc->x_dot_start;
    /* Where the acceleration is 0 its rate decides. */
    const double rise = arc->mode * (slip->acceleration != 0.0 ? slip->acceleration : slip->fade);
    if (start > limit || (start == limit && rise > 0.0)) {
        arc->of.falling.passed_limit = true;
        return 0.0;
    }
    if (start == 0.0 && arc->mode * slip->acceleration < 0.0) return 0.0;
    if (start > 0.0 && rise == 0.0 && slip->oscillator.c >= 0.0) return HUGE_VAL;
    const double growth = -slip->oscillator.slow;
    const double most = growth > 0.0 ? MOST_GROWTH / growth : DBL_MAX;
    struct extremes walk = {.before = HUGE_VAL};
    double low = 0.0, extreme;
    while (next_extreme(arc, &walk, &extreme)) {
        const double high = extreme < most ? extreme : enclose_tail(arc, low, most);
        if (high == HUGE_VAL) break;
        const double speed = speed_at(arc, high);
        if (speed <= 0.0) return falling_zero(coulomb_slip_speed, arc, low, high);
        if (speed > limit) {
            arc->of.falling.passed_limit = true;
            return falling_zero(below_limit, arc, low, high);
        }
        low = high;
    }
    return HUGE_VAL;
}

static double falling_extreme_velocity(const struct arc *arc, double tau)
{
    double extreme = arc->x_dot_start, time;
    const double now = coulomb_slip_state(arc, tau).x_dot;
    if (fabs(now) > fabs(extreme)) extreme = now;
    struct extremes walk = {.before = tau};
    while (next_extreme(arc, &walk, &time)) {
        if (!(time < tau)) continue;
        const double there = coulomb_slip_state(arc, time).x_dot;
        if (fabs(there) > fabs(extreme)) extreme = there;
    }
    return extreme;
}

static double falling_heat(const struct arc *arc, double tau, double displacement)
{
    const struct oscillator *oscillator = &arc->of.coulomb.oscillator;
    const double heat = arc->of.coulomb.kinetic * fabs(displacement);
    if (oscillator->c == 0.0) return heat;
    if (oscillator->overdamped && oscillator->c < 0.0) {
        double panels[MOST_PANELS];
        const int count = (int)ceil(oscillator->quickest * tau / PANEL);
        for (int n = 0; n < count; n++)
            panels[n] = integral_of_square(coulomb_slip_speed, arc, tau * n / count,
                                           tau * (n + 1) / count);
        return heat + oscillator->c * exact_sum(panels, count);
    }
    return heat + oscillator->c * coulomb_slip_squared_velocity(arc, tau, displacement);
}

static enum refusal falling_under(struct friction *made, const struct settings *settings,
                                  const struct friction *before)
{
    (void)before;
    double normal;
    enum refusal refused = normal_force(settings, &normal);
    if (refused != ACCEPTED) return refused;
    struct friction it = {.settings = *settings};
    struct falling *own = &it.of.falling;
    own->mu_k_used = kinetic_coefficient(settings->mu_s, settings->mu_k);
    it.F_s = settings->mu_s * normal;
    it.kinetic = own->mu_k_used * normal;
    it.gap = (settings->mu_s - own->mu_k_used) * normal;
    if (!isfinite(it.F_s)) return NOT_FINITE;
    /* The rates without the fall have to be in range as well. */
    refused = oscillator_make(&own->oscillator, settings->k, settings->m, settings->c);
    if (refused != ACCEPTED) return refused;
    const double damping = settings->c - settings->slope * normal;
    refused = oscillator_make(&own->oscillator, settings->k, settings->m, damping);
    own->limit = settings->slope > 0.0 ? own->mu_k_used / settings->slope : HUGE_VAL;
    if (refused == ACCEPTED) *made = it;
    return refused;
}

static void falling_slip(const struct friction *it, int mode, double z, double x_dot, double net,
                         struct arc *made)
{
    const struct falling *own = &it->of.falling;
    const double v = it->settings.v;
    if (own->limit == HUGE_VAL) {
        coulomb_slip_make(&own->oscillator, v, z, x_dot, mode, net, it->kinetic, made);
        return;
    }
    coulomb_slip_begin(&own->oscillator, v, z, x_dot, mode, net, it->kinetic, made);
    made->tag = FALLING_SLIP;
    made->of.falling.limit = own->limit;
    made->of.falling.passed_limit = false;
    made->duration = find_end(made);
}

static enum refusal falling_after(const struct friction *it, const struct arc *ended, double z,
                                  struct arc *following)
{
    if (ended->tag == FALLING_SLIP && ended->of.falling.passed_limit) return LAW_ENDED;
    return sticking_after(it, ended, z, following);
}

static double falling_way(const struct friction *it, const struct arc *ended)
{
    return coulomb_slip_way_to_break_away(ended, it->gap);
}

static bool falling_same_slip(const struct friction *one, const struct friction *other)
{
    const struct settings *a = &one->settings, *b = &other->settings;
    return a->k == b->k && a->c == b->c && a->v == b->v && a->F_ext == b->F_ext &&
           one->kinetic == other->kinetic &&
           one->of.falling.oscillator.c == other->of.falling.oscillator.c &&
           one->of.falling.limit == other->of.falling.limit;
}

static bool falling_warns(const struct settings *settings)
{
    return is_clamped(settings->mu_s, settings->mu_k);
}

static double falling_output(const struct friction *it, enum reference reference)
{
    return reference == VR_mu_k_used ? it->of.falling.mu_k_used : 0.0;
}

static const struct arc_functions FALLING_SLIP_FUNCTIONS = {
    .start = coulomb_slip_start,
    .state = coulomb_slip_state,
    .end = coulomb_slip_end,
    .pull_work = coulomb_slip_pull_work,
    .heat = falling_heat,
    .extreme_velocity = falling_extreme_velocity,
    .own = coulomb_slip_own,
};

const struct arc_functions *const ARCS[ARC_TAGS] = {
    [STICK] = &STICK_FUNCTIONS,
    [COULOMB_SLIP] = &COULOMB_SLIP_FUNCTIONS,
    [FALLING_SLIP] = &FALLING_SLIP_FUNCTIONS,
};

const struct law LAW = {
    .under = falling_under,
    .hold = sticking_hold,
    .begin = sticking_begin,
    .after = falling_after,
    .arc = sticking_arc,
    .slip = falling_slip,
    .way_to_break_away = falling_way,
    .same_slip = falling_same_slip,
    .warns = falling_warns,
    .output = falling_output,
};
