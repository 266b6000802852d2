#include "piece.h"

#include "polynomial.h"
#include "series.h"
#include "shapes.h"

#include <math.h>

/* The last terms of the series, relative to the first ones, where the piece ends: 2^-50. */
static const double TAIL = 8.881784197001252e-16;
/* What the slope of the speed may differ from the force of the law, relative to the forces in it.
 * The error of the speed is 1/ORDER of it: 2^-47. */
static const double DEFECT = 7.105427357601002e-15;
static const double SHORTER = 0.8;
/* Longest piece in units of H; its powers stay in the range of numbers: 2^30. */
static const double LONGEST = 1073741824.0;
enum { MOST_TRIALS = 200 };
/* Factor by which H is shortened where the coefficients leave the range of numbers: 2^20. */
static const double QUICKER = 1048576.0;
enum { MOST_SCALES = 8 };

double smooth_friction(const struct smooth *it, double speed)
{
    return it->rest + it->drop * shape_left(&it->shape, speed / it->v_s);
}

/* The speed [m/s] at tau, and the way beyond that at the speed of the start [m]. */
static double along(const struct piece *it, double tau, double *more)
{
    const double s = tau / it->scale;
    double speed = 0.0, way = 0.0;
    for (int j = ORDER; j > 0; j--) {
        speed = (speed + it->speeds[j]) * s;
        way = (way + it->speeds[j] / (j + 1)) * s;
    }
    *more = way * tau;
    return speed + it->speeds[0];
}

/* Make the series from this speed [m/s] and net force [N] along the slip. */
static enum refusal expand(struct piece *made, int mode, double speed, double net)
{
    const struct smooth *law = &made->law;
    const struct fall_shape *shape = &law->shape;
    const double first = speed / law->v_s;
    const double steep = law->drop / law->v_s * shape_steepness(shape, first);
    double rate = law->w + (law->c + steep) / law->m;
    double *speeds = made->speeds;
    struct expansion given = {
        .q = first,
        .inner = shape_inner(shape, first),
        .fall = shape_left(shape, first),
        .fallen = shape_fallen(shape, first),
        .driving = net + law->drop * shape_fallen(shape, first),
        .D = law->drop,
    };
    for (int trial = 0; trial < MOST_SCALES; trial++) {
        const double scale = 1.0 / rate;
        given.A = scale / (law->m * law->v_s);
        given.C = scale * law->c / law->m;
        given.S = scale * law->k * law->v_s;
        given.pulled = scale * law->k * (mode * law->v);
        series_expand(shape, &given, speeds, made->fall);
        for (int j = 0; j <= ORDER; j++) speeds[j] = law->v_s * speeds[j];
        made->scale = scale;
        /* The last coefficient of the speed has all others in it, those of friction too. */
        if (fabs(speeds[ORDER]) < HUGE_VAL) break;
        /* The motion is quicker than its start shows. */
        rate *= QUICKER;
    }
    return isfinite(speeds[ORDER]) ? ACCEPTED : NOT_FINITE;
}

/* The s up to which the last terms of the series are below rounding. */
static double reach_of(const struct piece *it)
{
    const struct smooth *law = &it->law;
    const double *speeds = it->speeds;
    const double per_force = it->scale / law->m * law->drop;
    double largest = fabs(speeds[0]), end = HUGE_VAL;
    for (int j = 1; j < 4; j++)
        if (fabs(speeds[j]) > largest) largest = fabs(speeds[j]);
    for (int j = ORDER - 1; j <= ORDER; j++) {
        const double terms[] = {fabs(speeds[j]), per_force * fabs(it->fall[j - 1]) / j};
        for (int n = 0; n < 2; n++) {
            if (!(terms[n] > 0.0)) continue;
            const double reach = pow(TAIL * largest / terms[n], 1.0 / j);
            if (reach < end) end = reach;
        }
    }
    if (end < HUGE_VAL) return LONGEST < end ? LONGEST : end;
    for (int j = 1; j <= ORDER; j++)
        if (speeds[j] != 0.0) return LONGEST;
    return HUGE_VAL;
}

/* Whether the slope of the speed at s, the last of the piece, is that of the force. */
static bool agrees(const struct arc *arc, double s, double net, bool stops)
{
    const struct piece *it = &arc->of.piece;
    const struct smooth *law = &it->law;
    const double speed = stops ? 0.0 : it->last_speed;
    if (!stops && !(speed > 0.0)) return false;
    double slope = 0.0;
    for (int position = ORDER; position > 0; position--)
        slope = slope * s + position * it->speeds[position];
    const double first = arc->mode * arc->x_dot_start, tau = s * it->scale;
    const double end = net + law->k * ((arc->mode * law->v - first) * tau - it->last_way);
    const double ratio = speed / law->v_s;
    const double drop = law->drop * shape_fallen(&law->shape, ratio);
    const double damping = law->c * speed;
    /* The last is what the friction may change by with the rounding of the speed. */
    const double forces = fabs(net) + fabs(end) + drop + damping +
                          law->drop * shape_steepness(&law->shape, ratio) * ratio;
    const double defect = end + drop - damping - law->m / it->scale * slope;
    return fabs(defect) <= DEFECT * forces;
}

/* When the slip or the piece ends, or infinity where the speed stays as it is [s]. */
static double find_end(struct arc *arc, double net)
{
    struct piece *it = &arc->of.piece;
    /* A slip from rest has zeros as its first coefficients. */
    int lowest = 0;
    while (lowest < ORDER && it->speeds[lowest] == 0.0) lowest++;
    if (it->speeds[lowest] < 0.0) return 0.0;
    double end = reach_of(it), last = end;
    if (end == HUGE_VAL) return HUGE_VAL;
    const struct polynomial rising = {&it->speeds[lowest], ORDER + 1 - lowest};
    bool stops = false;
    for (int trial = 0; trial < MOST_TRIALS; trial++) {
        last = end;
        stops = polynomial_first_zero(rising, end, &last);
        it->last_speed = along(it, last * it->scale, &it->last_way);
        if (agrees(arc, last, net, stops)) break;
        end = SHORTER * last;
    }
    it->leaves = !stops;
    if (stops) it->last_speed = 0.0;
    return last * it->scale;
}

enum refusal piece_make(const struct smooth *law, double z, double x_dot, int mode, double net,
                        struct arc *made)
{
    struct piece *piece = &made->of.piece;
    made->tag = PIECE;
    made->mode = mode;
    made->z_start = z;
    made->x_dot_start = x_dot;
    made->age = 0.0;
    piece->law = *law;
    piece->net = net;
    piece->last_speed = mode * x_dot;
    piece->last_way = 0.0;
    piece->leaves = false;
    const enum refusal refused = expand(piece, mode, mode * x_dot, mode * net);
    if (refused == ACCEPTED) made->duration = find_end(made, mode * net);
    return refused;
}

static void piece_start(const struct arc *arc, struct start *start)
{
    *start = (struct start){.mode = arc->mode,
                            .known = true,
                            .z = arc->z_start,
                            .x_dot = arc->x_dot_start,
                            .force = arc->of.piece.net};
}

/* The motion at tau, for its speed [m/s] and the way beyond that at the speed of the start [m]. */
static struct motion motion_at(const struct arc *arc, double tau, double speed, double more)
{
    const struct smooth *law = &arc->of.piece.law;
    const int mode = arc->mode;
    /* Rounding beside an end of the slip; the motion itself never turns. */
    if (speed < 0.0) speed = 0.0;
    const double first = mode * arc->x_dot_start;
    const double x_dot = mode * speed;
    return (struct motion){
        .growth = mode * ((mode * law->v - first) * tau - more),
        .x_dot = x_dot,
        .displacement = mode * (first * tau + more),
        .friction = -(mode * smooth_friction(law, speed) + law->c * x_dot),
    };
}

static struct motion piece_state(const struct arc *arc, double tau)
{
    double more;
    const double speed = along(&arc->of.piece, tau, &more);
    return motion_at(arc, tau, speed, more);
}

static struct motion piece_end(const struct arc *arc)
{
    return motion_at(arc, arc->duration, arc->of.piece.last_speed, arc->of.piece.last_way);
}

double piece_exit_speed(const struct arc *ended)
{
    return ended->of.piece.last_speed;
}

double piece_net_at_end(const struct arc *ended, double growth)
{
    return ended->of.piece.net + ended->of.piece.law.k * growth;
}

double piece_way_to_break_away(const struct arc *ended, double gap)
{
    return gap - ended->mode * piece_net_at_end(ended, piece_end(ended).growth);
}

static double piece_extreme_velocity(const struct arc *arc, double tau)
{
    const struct piece *piece = &arc->of.piece;
    const struct polynomial speeds = {piece->speeds, ORDER + 1};
    return arc->mode * polynomial_highest(speeds, tau / piece->scale);
}

/* (15) */
static double piece_pull_work(const struct arc *arc, double tau)
{
    const struct piece *piece = &arc->of.piece;
    const struct smooth *law = &piece->law;
    const double s = tau / piece->scale;
    double more = 0.0;
    for (int j = ORDER; j > 0; j--) more = (more + piece->speeds[j] / (j + 1) / (j + 2)) * s;
    more *= tau * tau;
    const double first = arc->mode * arc->x_dot_start;
    const double growth = arc->mode * (0.5 * (arc->mode * law->v - first) * tau * tau - more);
    return law->k * law->v * (arc->z_start * tau + growth);
}

/* (15). From the product of the series of speed and friction, each coefficient added up from the
 * lowest power of the speed on; its integral by Horner's scheme. */
static double piece_heat(const struct arc *arc, double tau, double displacement)
{
    (void)displacement;
    const struct piece *piece = &arc->of.piece;
    const struct smooth *law = &piece->law;
    const double *speeds = piece->speeds;
    const double s = tau / piece->scale;
    double forces[ORDER], total = 0.0;
    for (int j = 0; j < ORDER; j++) forces[j] = law->drop * piece->fall[j] + law->c * speeds[j];
    forces[0] += law->rest;
    for (int j = ORDER - 1; j >= 0; j--) {
        double power = speeds[0] * forces[j];
        for (int i = 1; i <= j; i++) power += speeds[i] * forces[j - i];
        total = (total + power / (j + 1)) * s;
    }
    return total * piece->scale;
}

const struct arc_functions PIECE_FUNCTIONS = {
    .start = piece_start,
    .state = piece_state,
    .end = piece_end,
    .pull_work = piece_pull_work,
    .heat = piece_heat,
    .extreme_velocity = piece_extreme_velocity,
};
