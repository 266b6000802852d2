#include "ramp.h"

#include "numerics.h"
#include "polynomial.h"
#include "series.h"
#include "sticking.h"

#include <float.h>
#include <math.h>

const enum reference MOVES[MOVING] = {VR_v, VR_load, VR_F_ext};

/* The last terms of a series, relative to the first ones, where a piece ends: 2^-50. */
static const double TAIL = 8.881784197001252e-16;
/* What the slope of the speed may differ from the forces, relative to them: 2^-47. */
static const double DEFECT = 7.105427357601002e-15;
/* How far a speed that two bands hand to each other goes on in one, relative to it: 2^-46. */
static const double EDGE = 1.4210854715202004e-14;
/* Pieces are of no length if so short beside what is left of the step: 2^-30. */
static const double BRIEF = 9.313225746154785e-10;
static const double SHORTER = 0.8, QUICKER = 1048576.0;
/* Length of a piece of a growth in stick, as parts of its time constant and of t_0 and its age. */
static const double EXPONENTIAL = 2.0, LOGARITHM = 0.2, OVER = 40.0;
enum { MOST_TRIALS = 200, MOST_PIECES = 1 << 20, TERMS = ORDER + 1 };

/* Where the motion is, with the inputs and their rates. */
struct walk {
    struct block *block;
    struct friction unit; /* the friction under the weight alone, to which it is in proportion */
    double k, m, c;
    double v, v_rate;         /* [m/s], [m/s2] */
    double ratio, ratio_rate; /* normal force over the weight [1], [1/s] */
    double F_ext, F_rate;     /* [N], [N/s] */
    double time, left;        /* now, and up to the end of the step [s] */
    int mode;
    double z, x_dot, age;
    double net;  /* on the mass along a slip, with the friction at standstill [N] */
    bool rises;  /* whether the speed of a slip goes up */
    int stuck;   /* how many pieces in a row had no length */
};

/* A piece of a slip in the time s = t/scale, along its direction. */
struct ramped {
    struct part part;
    double scale, speeds[TERMS], fall[ORDER];
    double end; /* s */
    enum { GOES_ON, STOPS, LEAVES_UP, LEAVES_DOWN } how;
};

/* Inputs and time after a part of the step. */
static void move(struct walk *it, double tau)
{
    it->v += it->v_rate * tau;
    it->ratio += it->ratio_rate * tau;
    it->F_ext += it->F_rate * tau;
    it->time += tau;
    it->left -= tau;
}

/* Whether a polynomial comes down to 0 by `end`. One that starts there has gone up first. */
static bool falls_to_zero(const double terms[], int count, double end, double *zero)
{
    int lowest = 0;
    while (lowest < count - 1 && terms[lowest] == 0.0) lowest++;
    *zero = 0.0;
    if (terms[lowest] < 0.0) return true;
    if (terms[lowest] == 0.0) return false;
    const struct polynomial rising = {&terms[lowest], count - lowest};
    return polynomial_first_zero(rising, end, zero);
}

/* Whether the first growth in a stick is not over, to rounding. */
static bool lasts(const struct walk *it)
{
    return it->unit.dwell.rise > 0.0 && it->age < OVER * it->unit.dwell.tau_s;
}

/* The coefficients of the growth of the break-away force from the age of the walk on, in s = t/scale,
 * under the weight. */
static void growth_terms(const struct walk *it, double scale, double terms[TERMS])
{
    const struct dwell *dwell = &it->unit.dwell;
    double decay = lasts(it) ? -dwell->rise * exp(-it->age / dwell->tau_s) : 0.0;
    double power = -dwell->strength;
    terms[0] = dwell_growth(dwell, it->age);
    for (int j = 1; j < TERMS; j++) {
        if (decay != 0.0) decay *= -(scale / dwell->tau_s) / j;
        if (dwell->strength > 0.0) power *= -(scale / (dwell->t_0 + it->age));
        terms[j] = decay + power / j;
    }
}

/* Go along a stick, up to break-away or the end of the step. */
static enum refusal pass_stick(struct walk *it)
{
    const struct dwell *dwell = &it->unit.dwell;
    const double left = it->left;
    double scale = left;
    const bool ages = dwell->rise > 0.0 || dwell->strength > 0.0;
    if (lasts(it)) scale = fmin(scale, EXPONENTIAL * dwell->tau_s);
    if (dwell->strength > 0.0) scale = fmin(scale, LOGARITHM * (dwell->t_0 + it->age));
    const int count = ages ? TERMS : 3;
    double growth[TERMS] = {0.0}, hold[TERMS], lacks[TERMS], first = HUGE_VAL;
    if (ages) growth_terms(it, scale, growth);
    const double force[3] = {it->k * it->z + it->F_ext, (it->k * it->v + it->F_rate) * scale,
                             0.5 * it->k * it->v_rate * scale * scale};
    int direction = 0;
    for (int j = 0; j < count; j++)
        hold[j] = it->ratio * growth[j] + (j > 0 ? it->ratio_rate * scale * growth[j - 1] : 0.0);
    hold[0] += it->unit.F_s * it->ratio;
    hold[1] += it->unit.F_s * it->ratio_rate * scale;
    for (int sign = -1; sign <= 1; sign += 2) {
        double zero;
        for (int j = 0; j < count; j++) lacks[j] = hold[j] - (j < 3 ? sign * force[j] : 0.0);
        const double exact = lacks[0];
        lacks[0] += rest_slack(it->k * it->z, it->F_ext, hold[0]);
        if (!falls_to_zero(lacks, count, 1.0, &zero)) continue;
        lacks[0] = exact;
        const struct polynomial within = {lacks, count};
        if (exact > 0.0) zero = falling_zero(polynomial_graph, &within, 0.0, zero);
        if (!(zero < first)) continue;
        first = zero;
        direction = sign;
    }
    const double tau = direction == 0 ? scale : first * scale;
    const double growth_of_z = (it->v + 0.5 * it->v_rate * tau) * tau;
    struct block *block = it->block;
    block->W_pull = sum_with(block->W_pull, it->k * growth_of_z * (it->z + 0.5 * growth_of_z));
    meter_pass_stick(&block->meter, tau);
    it->z += growth_of_z;
    it->age += tau;
    move(it, tau);
    if (direction == 0) {
        if (scale >= left) it->left = 0.0;
        return ACCEPTED;
    }
    const double gap = it->unit.gap + dwell_growth(dwell, it->age);
    meter_break_away(&block->meter, it->time);
    it->mode = direction;
    it->net = gap * it->ratio;
    it->rises = true;
    return ACCEPTED;
}

/* The force on the mass along the slip at this speed, but for what `net` holds [N], and all forces in
 * it together. */
static double resistance(const struct walk *it, const struct part *part, double ratio, double speed,
                         double *together)
{
    const double fallen = part->drop * shape_fallen(&part->shape, speed / part->v_s);
    const double line = part->band.rise + part->band.slope * speed;
    *together = ratio * (fabs(part->band.rise) + fabs(part->band.slope * speed) + fallen +
                         part->drop * shape_steepness(&part->shape, speed / part->v_s) * speed /
                             part->v_s) +
                it->c * speed;
    return ratio * (line - fallen) + it->c * speed;
}

/* Make the series of a piece from where the walk stands. */
static enum refusal expand(const struct walk *it, struct ramped *made)
{
    const struct part *part = &made->part;
    const double v_s = part->v_s, speed = it->mode * it->x_dot, first = speed / v_s;
    const double slope =
        fabs(part->band.slope) + part->drop / v_s * shape_steepness(&part->shape, first);
    double rate = sqrt(it->k / it->m) + (it->c + slope * it->ratio) / it->m;
    struct expansion given = {
        .q = first,
        .inner = shape_inner(&part->shape, first),
        .fall = shape_left(&part->shape, first),
        .fallen = shape_fallen(&part->shape, first),
        .D = part->drop * it->ratio,
    };
    given.driving = it->net + it->ratio * (part->drop * given.fallen - part->band.rise);
    for (int trial = 0; trial < MOST_TRIALS; trial++) {
        const double scale = made->scale = 1.0 / rate;
        given.A = scale / (it->m * v_s);
        given.C = scale * (it->c + part->band.slope * it->ratio) / it->m;
        given.S = scale * it->k * v_s;
        given.pulled = scale * (it->mode * (it->k * it->v + it->F_rate) -
                                (it->unit.kinetic + part->band.rise) * it->ratio_rate);
        given.D_gained = scale * part->drop * it->ratio_rate;
        given.C_gained = scale * scale * part->band.slope * it->ratio_rate / it->m;
        given.pulled_gained = 0.5 * scale * scale * it->k * (it->mode * it->v_rate);
        series_expand(&part->shape, &given, made->speeds, made->fall);
        for (int j = 0; j < TERMS; j++) made->speeds[j] *= v_s;
        if (fabs(made->speeds[ORDER]) < HUGE_VAL) return ACCEPTED;
        rate *= QUICKER;
    }
    return NOT_FINITE;
}

/* The s up to which the last terms are below rounding, and the step lasts. */
static double reach_of(const struct walk *it, const struct ramped *piece)
{
    const double per_force = piece->scale / it->m * piece->part.drop * it->ratio;
    double largest = 0.0, end = it->left / piece->scale;
    for (int j = 0; j < 4; j++) largest = fmax(largest, fabs(piece->speeds[j]));
    for (int j = ORDER - 1; j <= ORDER; j++) {
        const double term = fmax(fabs(piece->speeds[j]), per_force * fabs(piece->fall[j - 1]) / j);
        if (term > 0.0) end = fmin(end, pow(TAIL * largest / term, 1.0 / j));
    }
    return end;
}

/* The way along the slip up to s [m]. */
static double way_of(const struct ramped *piece, double s)
{
    double way = 0.0;
    for (int j = ORDER; j >= 0; j--) way = (way + piece->speeds[j] / (j + 1)) * s;
    return way * piece->scale;
}

/* What `net` is at the end of a piece [N]. */
static double net_after(const struct walk *it, const struct ramped *piece)
{
    const double tau = piece->end * piece->scale;
    const double pulled = it->mode * (it->v + 0.5 * it->v_rate * tau) * tau;
    return it->net + it->k * (pulled - way_of(piece, piece->end)) +
           (it->mode * it->F_rate - it->unit.kinetic * it->ratio_rate) * tau;
}

/* Whether the slope of the speed at the end is that of the forces there. */
static bool agrees(const struct walk *it, const struct ramped *piece)
{
    const struct polynomial speeds = {piece->speeds, TERMS};
    double speed, slope, together;
    polynomial_graph(&speeds, piece->end, &speed, &slope);
    if (speed < 0.0) speed = 0.0;
    const double net = net_after(it, piece);
    const double ratio = it->ratio + it->ratio_rate * piece->end * piece->scale;
    const double against = resistance(it, &piece->part, ratio, speed, &together);
    const double defect = net - against - it->m / piece->scale * slope;
    return fabs(defect) <= DEFECT * (fabs(it->net) + fabs(net) + together +
                                     it->unit.kinetic * (fabs(it->ratio) + fabs(ratio)));
}

/* Find where a piece ends, and how. */
static void find_end(const struct walk *it, struct ramped *piece)
{
    const struct band *band = &piece->part.band;
    double end = reach_of(it, piece), zero, edge[TERMS];
    /* Where the forces balance at an end of two bands, rounding would have each hand it on. */
    const double beyond = it->stuck < 2 ? 0.0 : EDGE;
    for (int trial = 0; trial < MOST_TRIALS; trial++) {
        piece->end = end;
        piece->how = GOES_ON;
        if (falls_to_zero(piece->speeds, TERMS, piece->end, &zero)) {
            piece->end = zero;
            piece->how = STOPS;
        }
        for (int j = 0; j < TERMS; j++) edge[j] = piece->speeds[j];
        edge[0] -= band->low * (1.0 - beyond);
        if (band->low > 0.0 && falls_to_zero(edge, TERMS, piece->end, &zero)) {
            piece->end = zero;
            piece->how = LEAVES_DOWN;
        }
        for (int j = 0; j < TERMS; j++) edge[j] = -piece->speeds[j];
        edge[0] += band->high * (1.0 + beyond);
        if (band->high < HUGE_VAL && falls_to_zero(edge, TERMS, piece->end, &zero)) {
            piece->end = zero;
            piece->how = LEAVES_UP;
        }
        if (piece->end == 0.0 || agrees(it, piece)) break;
        end = SHORTER * piece->end;
    }
    /* Products of coefficients stay in the range of numbers where s ends at 1. */
    double power = 1.0;
    for (int j = 0; j < TERMS; j++, power *= piece->end) {
        piece->speeds[j] *= power;
        if (j < ORDER) piece->fall[j] *= power;
    }
    piece->scale *= piece->end;
    piece->end = 1.0;
}

/* The integral of a product of polynomials from 0 to s. */
static double product_integral(const double one[], int count, const double other[], int others,
                               double s)
{
    double total = 0.0;
    for (int power = count + others - 2; power >= 0; power--) {
        double term = 0.0;
        for (int i = power < count ? power : count - 1; i >= 0 && power - i < others; i--)
            term += one[i] * other[power - i];
        total = (total + term / (power + 1)) * s;
    }
    return total;
}

/* Add a piece to sums and meter. */
static void bank(const struct walk *it, const struct ramped *piece, double way, double growth)
{
    const struct part *part = &piece->part;
    const double scale = piece->scale, s = piece->end, *speeds = piece->speeds;
    const double v[2] = {it->v, it->v_rate * scale};
    double extension[TERMS + 1], mu[ORDER] = {0.0}, force[TERMS];
    struct block *block = it->block;
    extension[0] = it->z;
    for (int j = 0; j < TERMS; j++)
        extension[j + 1] = scale * ((j < 2 ? v[j] : 0.0) - it->mode * speeds[j]) / (j + 1);
    for (int j = 0; j < ORDER; j++)
        mu[j] = part->band.slope * speeds[j] + part->drop * piece->fall[j];
    mu[0] += it->unit.kinetic + part->band.rise - part->drop;
    for (int j = 0; j < ORDER; j++)
        force[j] = it->ratio * mu[j] + (j > 0 ? it->ratio_rate * scale * mu[j - 1] : 0.0) +
                   it->c * speeds[j];
    const double tau = s * scale;
    const double work = product_integral(v, 2, extension, TERMS + 1, s);
    const double heat = product_integral(force, ORDER, speeds, TERMS, s);
    const struct polynomial highest = {speeds, TERMS};
    block->x_start = sum_with(block->x_start, it->mode * way);
    block->W_pull = sum_with(block->W_pull, it->k * scale * work);
    block->Q_friction = sum_with(block->Q_friction, scale * heat);
    meter_pass_slip(&block->meter, tau, it->mode * way, -growth,
                    it->mode * polynomial_highest(highest, s));
}

/* Come to rest, and stick or slip the other way. */
static void rest(struct walk *it)
{
    const double spring = it->k * it->z;
    meter_end_slip(&it->block->meter, it->time);
    it->x_dot = it->age = 0.0;
    const int direction = direction_from_rest(spring, it->F_ext, it->unit.F_s * it->ratio);
    it->mode = direction == -it->mode ? direction : 0;
    it->net = it->mode * (spring + it->F_ext) - it->unit.kinetic * it->ratio;
    it->rises = true;
}

/* Go along a piece of a slip. */
static enum refusal pass_slip(struct walk *it)
{
    struct ramped piece;
    const double rate = it->mode * (it->k * it->v + it->F_rate) - it->unit.kinetic * it->ratio_rate;
    LAW.part(&it->unit, it->mode * it->x_dot, it->rises, it->net, rate, &piece.part);
    const enum refusal refused = expand(it, &piece);
    if (refused != ACCEPTED) return refused;
    find_end(it, &piece);
    const double tau = piece.end * piece.scale, way = way_of(&piece, piece.end);
    const struct polynomial speeds = {piece.speeds, TERMS};
    const double growth = (it->v + 0.5 * it->v_rate * tau) * tau - it->mode * way;
    const double net = net_after(it, &piece), left = it->left;
    bank(it, &piece, way, growth);
    double speed = polynomial_value(speeds, piece.end);
    if (piece.how == LEAVES_UP) speed = piece.part.band.high;
    if (piece.how == LEAVES_DOWN) speed = piece.part.band.low;
    it->x_dot = it->mode * (speed > 0.0 ? speed : 0.0);
    it->z += growth;
    it->net = net;
    it->rises = piece.how != LEAVES_DOWN;
    it->stuck = tau > BRIEF * left ? 0 : it->stuck + 1;
    move(it, tau);
    if (piece.how == STOPS)
        rest(it);
    else if (tau >= left)
        it->left = 0.0;
    return ACCEPTED;
}

/* Begin to walk where the block stands. */
static enum refusal set_out(struct walk *it, struct block *block, double time, double step,
                            const double ends[MOVING])
{
    double together;
    *it = (struct walk){.block = block, .time = time, .left = step};
    enum refusal refused = block_lift(block, time, &it->age);
    if (refused != ACCEPTED) return refused;
    const struct settings *now = &block->friction.settings;
    struct settings weight = *now;
    weight.load = 0.0;
    refused = LAW.under(&it->unit, &weight, NULL);
    if (refused != ACCEPTED) return refused;
    const double mg = now->m * now->g;
    it->k = now->k;
    it->m = now->m;
    it->c = now->c;
    it->v = now->v;
    it->ratio = (mg + now->load) / mg;
    it->F_ext = now->F_ext;
    it->v_rate = (ends[0] - now->v) / step;
    it->ratio_rate = (ends[1] - now->load) / mg / step;
    it->F_rate = (ends[2] - now->F_ext) / step;
    it->mode = block->mode;
    it->z = block->z;
    it->x_dot = block->x_dot;
    const double friction = it->unit.kinetic * it->ratio;
    it->net = it->mode * (it->k * it->z + it->F_ext) - friction;
    struct part part;
    LAW.part(&it->unit, it->mode * it->x_dot, true, it->net, 0.0, &part);
    it->rises = it->net > resistance(it, &part, it->ratio, it->mode * it->x_dot, &together);
    const double sizes = it->v_rate + it->ratio_rate + it->F_rate;
    return isfinite(sizes) ? ACCEPTED : NOT_FINITE;
}

enum refusal ramp_advance(struct block *block, double time, double step, const double ends[MOVING])
{
    struct walk walk;
    const struct block entry = *block;
    if (!(0.0 < step && step <= DBL_MAX)) return STEP_OUT_OF_RANGE;
    if (!isfinite(time)) return TIME_OUT_OF_RANGE;
    enum refusal refused = set_out(&walk, block, time, step, ends);
    for (int n = 0; n < MOVING; n++) block_set(block, MOVES[n], ends[n]);
    if (refused == ACCEPTED) refused = block_check(block);
    /* What is left below rounding is nothing: where force and friction reach 0 at the end, the mass
     * would stick and slip in it without end. */
    const double nothing = 4.0 * DBL_EPSILON * step;
    for (long pieces = 0; walk.left > nothing && refused == ACCEPTED; pieces++) {
        refused = walk.mode == 0 ? pass_stick(&walk) : pass_slip(&walk);
        if (pieces == MOST_PIECES) {
            *block = entry;
            return TOO_MANY_TRANSITIONS;
        }
    }
    if (refused != ACCEPTED) return refused;
    return block_land(block, time + step, walk.mode, walk.z, walk.x_dot, walk.age);
}
