#include "whole.h"

#include "numerics.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* The spring turns where the velocity passes v by more than this part of it: rounding. Where it has
 * just turned, the velocity may be as much as the second part on the wrong side. */
static const double SLACK = 1e-12, TURNED = 1e-9;
/* The first stride of a run, of the time in which the spring moves by what errors count from. */
static const double FIRST = 1e-4;

static struct system system_of(const struct whole *it)
{
    struct system system = {.field = medium_field, .reach = medium_reach, .context = it};
    medium_scales(&it->medium, &system);
    return system;
}

/* The values at tau, beginning with the stride itself. */
static void values_at(const struct whole *it, double tau, double y[COLUMNS])
{
    if (tau == it->duration || tau <= 0.0) {
        memcpy(y, tau <= 0.0 ? it->from : it->to, sizeof it->to);
        return;
    }
    const struct system system = system_of(it);
    stride_to(&system, it->from, (struct stride){tau, it->done.rows}, y);
}

static struct speed speed_of(const struct whole *it, const double y[COLUMNS])
{
    double rates[COLUMNS];
    medium_field(it, y, rates, NULL);
    return medium_speed(&it->medium, y, rates);
}

/* What is to pass through zero, downward: the distance of the velocity from a level. */
struct distance {
    const struct whole *whole;
    double sign, level;
    double bend; /* an estimate of the slope of the slope */
};

static double distance_at(const struct distance *it, double tau, double *slope)
{
    double y[COLUMNS];
    values_at(it->whole, tau, y);
    const struct speed speed = speed_of(it->whole, y);
    *slope = it->sign * speed.x_ddot;
    return it->sign * (speed.x_dot - it->level);
}

static void distance_graph(const void *context, double at, double *value, double *slope)
{
    *value = distance_at(context, at, slope);
}

/* The slope with its sign turned, where it rises through zero. */
static void slope_graph(const void *context, double at, double *value, double *slope)
{
    const struct distance *it = context;
    distance_at(it, at, value);
    *value *= copysign(1.0, -it->bend);
    *slope = -fabs(it->bend);
}

/* Where the slope of the distance changes its sign, which it does between 0 and tau. */
static double turn_of(struct distance *it, double slope, double later, double tau)
{
    it->bend = (later - slope) / tau;
    return falling_zero(slope_graph, it, 0.0, tau);
}

/* The first time up to tau at which sign (x_dot - level) falls below zero, else infinity. */
static double crossing(const struct whole *whole, double sign, double level, double slack, double tau)
{
    struct distance it = {.whole = whole, .sign = sign, .level = level};
    double slope, later, low = 0.0, high = tau;
    const double first = distance_at(&it, 0.0, &slope), last = distance_at(&it, tau, &later);
    const bool begins = slope > 0.0 && fabs(first) <= TURNED / SLACK * slack;
    if (!begins && (first < -slack || (first <= 0.0 && last < -slack))) return 0.0;
    if (last < -slack) {
        if (begins) low = turn_of(&it, slope, later, tau);
    } else {
        if (!(slope < 0.0 && later > 0.0)) return HUGE_VAL;
        /* Between its tangents it stays above where they meet. */
        const double meet = (last - first - later * tau) / (slope - later);
        if (first + slope * meet >= -slack) return HUGE_VAL;
        high = turn_of(&it, slope, later, tau);
        if (distance_at(&it, high, &later) >= -slack) return HUGE_VAL;
    }
    return falling_zero(distance_graph, &it, low, high);
}

enum refusal whole_arc(const struct friction *it, const struct start *start, struct arc *made)
{
    struct whole whole = {.medium = *medium_of(it), .start = *start, .direction = 1.0};
    if (!(start->own.rows >= 0.0 && start->own.rows <= MOST_ROWS)) return NO_SUCH_STATE;
    struct stride tried = {.length = start->own.stride, .rows = (int)start->own.rows};
    const struct system system = system_of(&whole);
    const double v = whole.medium.v;
    medium_start(&whole.medium, start->z, start->x_dot, &start->own, whole.from);
    const struct speed speed = speed_of(&whole, whole.from);
    whole.direction = copysign(1.0, speed.x_dot != 0.0    ? speed.x_dot
                                    : speed.x_ddot != 0.0 ? speed.x_ddot
                                                          : v);
    if (!(tried.length > 0.0)) {
        double length = HUGE_VAL, rates[COLUMNS];
        medium_field(&whole, whole.from, rates, NULL);
        for (int i = 0; i < UNKNOWNS; i++)
            if (rates[i] != 0.0) length = fmin(length, FIRST * system.scales[i].least / fabs(rates[i]));
        tried.length = length < HUGE_VAL ? length : FIRST;
    }
    if (!stride_far(&system, whole.from, &tried, whole.to, &whole.next)) return NOT_FOLLOWED;
    whole.done = tried;
    whole.duration = tried.length;
    const double least = medium_least_speed(&whole.medium);
    const double stop = crossing(&whole, whole.direction, 0.0, SLACK * least, tried.length);
    const double turn = crossing(&whole, (start->mode == 0 ? -1.0 : 1.0) * copysign(1.0, v), v,
                                 SLACK * fabs(v), fmin(stop, tried.length));
    const double ends = fmin(stop, turn);
    if (ends <= tried.length) {
        values_at(&whole, ends, whole.to);
        whole.duration = ends;
        whole.event = turn <= stop ? SPRING_TURNS : MASS_STOPS;
        whole.next = tried;
    }
    *made = (struct arc){.tag = WHOLE,
                         .mode = start->mode,
                         .duration = whole.duration,
                         .z_start = start->z,
                         .x_dot_start = speed.x_dot,
                         .of.whole = whole};
    return ACCEPTED;
}

/* The mode of a motion of the meter: 0 where the spring grows, else the direction of the pull. */
static int mode_of(double x_dot, double v)
{
    const double way = copysign(1.0, v);
    return way * (x_dot - v) > 0.0 ? (int)way : 0;
}

enum refusal whole_begin(const struct friction *it, int mode, double z, double x_dot, double age,
                         const struct own *own, struct arc *begun)
{
    struct start start = {.mode = mode, .known = true, .z = z, .x_dot = x_dot};
    double from[COLUMNS];
    (void)age;
    start.own = own == NULL ? medium_own(it) : medium_changed(it, *own);
    struct whole whole = {.medium = *medium_of(it), .start = start, .direction = 1.0};
    medium_start(&whole.medium, z, x_dot, &start.own, from);
    if (own == NULL) start.mode = mode_of(speed_of(&whole, from).x_dot, whole.medium.v);
    return whole_arc(it, &start, begun);
}

static void whole_start(const struct arc *arc, struct start *start)
{
    *start = arc->of.whole.start;
}

static struct motion whole_state(const struct arc *arc, double tau)
{
    const struct whole *it = &arc->of.whole;
    double y[COLUMNS];
    struct motion motion = {0};
    values_at(it, tau, y);
    motion.growth = y[0];
    if (tau < it->duration || tau <= 0.0 || it->event == STRIDE_ENDS)
        motion.x_dot = speed_of(it, y).x_dot;
    else
        motion.x_dot = it->event == SPRING_TURNS ? it->medium.v : 0.0;
    motion.displacement = it->medium.v * tau - y[0];
    motion.friction = medium_friction(it, y, &motion.own.state);
    motion.own.stride = it->next.length;
    motion.own.rows = it->next.rows;
    return motion;
}

static struct motion whole_end(const struct arc *arc)
{
    return whole_state(arc, arc->duration);
}

enum refusal whole_after(const struct friction *it, const struct arc *ended, double z,
                         struct arc *following)
{
    const struct whole *whole = &ended->of.whole;
    const double v = it->settings.v;
    const struct motion end = whole_end(ended);
    struct start start = {
        .mode = ended->mode, .known = true, .z = z, .x_dot = end.x_dot, .own = end.own};
    if (whole->event == SPRING_TURNS) start.mode = ended->mode != 0 ? 0 : v < 0.0 ? -1 : 1;
    return whole_arc(it, &start, following);
}

static double whole_pull_work(const struct arc *arc, double tau)
{
    const struct whole *it = &arc->of.whole;
    double y[COLUMNS];
    values_at(it, tau, y);
    return it->medium.k * it->medium.v * (arc->z_start * tau + y[UNKNOWNS]);
}

static double whole_heat(const struct arc *arc, double tau, double displacement)
{
    double y[COLUMNS];
    (void)displacement;
    values_at(&arc->of.whole, tau, y);
    return y[UNKNOWNS + 1];
}

static double whole_extreme_velocity(const struct arc *arc, double tau)
{
    struct distance it = {.whole = &arc->of.whole, .sign = 1.0};
    double slope, later;
    const double first = distance_at(&it, 0.0, &slope), last = distance_at(&it, tau, &later);
    const double way = copysign(1.0, fabs(first) > fabs(last) ? first : last);
    if (way * slope > 0.0 && way * later < 0.0)
        return distance_at(&it, turn_of(&it, slope, later, tau), &slope);
    return fabs(first) > fabs(last) ? first : last;
}

const struct arc_functions WHOLE_FUNCTIONS = {
    .start = whole_start,
    .state = whole_state,
    .end = whole_end,
    .pull_work = whole_pull_work,
    .heat = whole_heat,
    .extreme_velocity = whole_extreme_velocity,
};

double whole_hold(const struct friction *it, double age)
{
    (void)age;
    return it->F_s;
}

/* Each change of a setting begins an arc, but what is set and set back. */
bool whole_same_slip(const struct friction *one, const struct friction *other)
{
    return memcmp(&one->settings, &other->settings, sizeof one->settings) == 0;
}
