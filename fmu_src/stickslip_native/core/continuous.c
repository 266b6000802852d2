#include "continuous.h"

#include "sticking.h"

#include <math.h>

/* Nominal states as parts of the largest: a slip grows from rest, where errors grow with it. */
static const double SMALL = 0.01;
/* How far below rest a slip ends, in nominal velocities: it begins at rest, where nothing ends. */
static const double BELOW_REST = 1e-8;
/* What a force may lack to break away, and a velocity to rest, where a solver says that it does:
 * at a change of sign, and at the time that was told, relative to the forces and velocities. */
static const double FOUND = 1e-10, TOLD = 1e-3;
/* How close to a time that was told an importer comes, relative to it. */
static const double ROUNDING = 1e-9;

static double extension(const struct continuous *it)
{
    return it->states[STATE_Z];
}

/* Spring and external force [N]. */
static double force_of(const struct continuous *it, const struct block *block)
{
    const struct settings *settings = &block->friction.settings;
    return settings->k * extension(it) + settings->F_ext;
}

/* Break-away force of the stick as old as it is [N]. */
static double hold_of(const struct continuous *it, const struct block *block)
{
    return LAW.hold(&block->friction, block->arc.age + (it->time - it->entered));
}

/* Friction of a slip without its viscous part [N]. */
static double kinetic_of(const struct continuous *it, const struct block *block)
{
    const double speed = block->mode * it->states[STATE_X_DOT];
    return block->mode * LAW.force(&block->friction, speed > 0.0 ? speed : 0.0);
}

void continuous_start(struct continuous *it, const struct block *block, double time)
{
    *it = (struct continuous){.time = time, .entered = time, .due = DBL_MAX};
    it->states[STATE_X] = block->x;
    it->states[STATE_X_DOT] = block->x_dot;
    it->states[STATE_Z] = block->z;
}

/* Importers that interpolate give an input that is held with the error of a rounding. */
static bool differs(double one, double other)
{
    return fabs(one - other) > ROUNDING * fabs(one);
}

/* Whether an input or parameter is not as at the last event. */
static bool is_set(const struct continuous *it, const struct block *block)
{
    const struct settings *wanted = &block->wanted, *acting = &block->friction.settings;
    for (int n = 0; n < VARIABLES && block->changed; n++) {
        const size_t offset = ROWS[n].offset;
        if (ROWS[n].tunable && *(const double *)((const char *)wanted + offset) !=
                                   *(const double *)((const char *)acting + offset))
            return true;
    }
    return differs(wanted->v, it->v) || differs(wanted->load, it->load) ||
           differs(wanted->F_ext, it->F_ext);
}

void continuous_note(struct continuous *it, const struct block *block)
{
    if (is_set(it, block)) it->moved = true;
}

enum refusal continuous_adopt(struct block *block)
{
    if (!block->changed) return ACCEPTED;
    const struct friction before = block->friction;
    block->changed = false;
    return LAW.under(&block->friction, &block->wanted, &before);
}

void continuous_rates(const struct continuous *it, const struct block *block, double rates[STATES])
{
    const struct settings *settings = &block->friction.settings;
    const double x_dot = it->states[STATE_X_DOT];
    rates[STATE_Z] = settings->v - (block->mode == 0 ? 0.0 : x_dot);
    rates[STATE_W_PULL] = settings->k * extension(it) * settings->v;
    rates[STATE_X] = rates[STATE_X_DOT] = rates[STATE_Q_FRICTION] = 0.0;
    if (block->mode == 0) return;
    const double friction = kinetic_of(it, block) + settings->c * x_dot;
    rates[STATE_X] = x_dot;
    rates[STATE_X_DOT] = (force_of(it, block) - friction) / settings->m;
    rates[STATE_Q_FRICTION] = friction * x_dot;
}

void continuous_indicators(const struct continuous *it, const struct block *block,
                           double indicators[INDICATORS])
{
    double rates[STATES], nominals[STATES];
    const double force = force_of(it, block);
    if (block->mode == 0) {
        indicators[0] = hold_of(it, block) - force;
        indicators[1] = hold_of(it, block) + force;
        return;
    }
    continuous_rates(it, block, rates);
    continuous_nominals(block, nominals);
    indicators[0] = block->mode * it->states[STATE_X_DOT] + BELOW_REST * nominals[STATE_X_DOT];
    /* The velocity has its extreme. */
    indicators[1] = block->mode * rates[STATE_X_DOT];
}

static double above_zero(double value, double otherwise)
{
    return value > 0.0 && value < HUGE_VAL ? value : otherwise;
}

void continuous_nominals(const struct block *block, double nominals[STATES])
{
    const struct settings *settings = &block->friction.settings;
    const double way = above_zero(block->friction.F_s / settings->k, 1e-3);
    const double swing = above_zero(way * sqrt(settings->k / settings->m), 1e-3);
    nominals[STATE_X] = nominals[STATE_Z] = SMALL * way;
    nominals[STATE_X_DOT] = SMALL * above_zero(fabs(settings->v), swing);
    const double energy = above_zero(settings->k * way * way, 1e-3);
    nominals[STATE_W_PULL] = nominals[STATE_Q_FRICTION] = SMALL * energy;
}

/* Whether a stick breaks away, and in which direction. */
static int breaks_away(const struct continuous *it, const struct block *block, bool told)
{
    const struct settings *settings = &block->friction.settings;
    const double force = force_of(it, block), hold = hold_of(it, block);
    const int direction =
        direction_from_rest(settings->k * extension(it), settings->F_ext, hold);
    const double along = force != 0.0 ? force : settings->v;
    const int sign = along > 0.0 ? 1 : -1;
    if (direction != 0 || (sign * settings->v <= 0.0 && !it->moved)) return direction;
    if (hold > 0.0) return hold - fabs(force) <= (told ? TOLD : FOUND) * hold ? sign : 0;
    /* Without a force to break away at, the mass rests while that grows faster than the pull. */
    struct arc stick;
    const enum refusal refused =
        LAW.begin(&block->friction, 0, extension(it), 0.0, 0.0, NULL, &stick);
    return refused == ACCEPTED && stick.duration > 0.0 ? 0 : sign;
}

/* Begin an arc where the solver stands, at rest for so long where the mode is 0. */
static enum refusal begin_arc(const struct continuous *it, struct block *block, int mode,
                              double age)
{
    const enum refusal refused = LAW.begin(&block->friction, mode, extension(it),
                                           it->states[STATE_X_DOT], age, NULL, &block->arc);
    block->mode = block->arc.mode;
    return refused;
}

/* Break away at the threshold, which a solver meets but for its error, with the gap of the forces
 * and not with what their difference leaves of it. */
static enum refusal break_away(struct continuous *it, struct block *block, int direction,
                               bool told)
{
    const struct friction *friction = &block->friction;
    const struct settings *settings = &friction->settings;
    const double hold = hold_of(it, block), gap = friction->gap + (hold - friction->F_s);
    double net = force_of(it, block) - direction * friction->kinetic;
    const double beyond = direction * force_of(it, block) - hold;
    if (beyond <= (told ? TOLD * hold : 0.0)) {
        it->states[STATE_Z] = (direction * hold - settings->F_ext) / settings->k;
        net = direction * gap;
    }
    const enum refusal refused =
        LAW.slip(friction, direction, extension(it), 0.0, net, &block->arc);
    block->mode = direction;
    meter_break_away(&block->meter, it->time);
    return refused;
}

/* Add what passed since the last event to the meter, and stand where the solver does. */
static void pass(struct continuous *it, struct block *block)
{
    const double tau = it->time - it->entered, x_dot = it->states[STATE_X_DOT];
    if (fabs(x_dot) > fabs(it->peak)) it->peak = x_dot;
    if (block->mode == 0)
        meter_pass_stick(&block->meter, tau);
    else
        meter_pass_slip(&block->meter, tau, it->states[STATE_X] - block->x_start.high,
                        block->arc.z_start - extension(it), it->peak);
    block->x_start = (struct sum){it->states[STATE_X], 0.0};
}

/* End a slip, and begin what follows. */
static enum refusal stop(struct continuous *it, struct block *block)
{
    const int mode = block->mode;
    it->states[STATE_X_DOT] = it->peak = 0.0;
    enum refusal refused = begin_arc(it, block, 0, 0.0);
    if (refused == ACCEPTED && block->mode != -mode) {
        it->entered = it->time;
        const int direction = breaks_away(it, block, false);
        if (direction != 0) refused = break_away(it, block, direction, false);
    }
    return refused;
}

enum refusal continuous_update(struct continuous *it, struct block *block)
{
    double nominals[STATES];
    const double k = block->friction.settings.k, time = it->time, z = extension(it);
    const double x_dot = it->states[STATE_X_DOT];
    const int mode = block->mode;
    const double early = fmin(ROUNDING * fabs(time), TOLD * (it->due - it->entered));
    const bool told = !it->moved && time + early >= it->due;
    const bool changed = is_set(it, block) || it->moved || !block->started;
    if (time == it->entered && !changed && !told) return ACCEPTED;
    enum refusal refused = continuous_adopt(block);
    if (refused != ACCEPTED) return refused;
    const bool unmoved = time == it->entered && x_dot == 0.0;
    block->W_k = sum_with(block->W_k, 0.5 * ((block->friction.settings.k - k) * z) * z);
    continuous_nominals(block, nominals);
    const double below = BELOW_REST * nominals[STATE_X_DOT];
    if (mode == 0) {
        const int direction = breaks_away(it, block, told);
        const double age = block->arc.age + (time - it->entered);
        pass(it, block);
        refused = direction != 0 ? break_away(it, block, direction, told)
                                 : begin_arc(it, block, 0, age);
    } else if (unmoved) {
        /* A slip of no length has not begun, so the rest test decides anew whether it does. */
        refused = begin_arc(it, block, 0, block->started ? 0.0 : block->friction.age_start);
        if (!block->started && block->mode != 0) meter_break_away(&block->meter, time);
    } else if (mode * x_dot <= -0.5 * below ||
               (told && SMALL * fabs(x_dot) <= TOLD * nominals[STATE_X_DOT])) {
        pass(it, block);
        meter_end_slip(&block->meter, time);
        refused = stop(it, block);
    } else {
        pass(it, block);
        refused = begin_arc(it, block, mode, 0.0);
    }
    if (refused != ACCEPTED) return refused;
    /* While nothing moves, the end of the whole arc stands: an arc begun anew on the way ends as the
     * errors of the solver have it, and near the critical velocity not at all. */
    if (changed || block->mode != mode || told) {
        const double next = it->moved ? HUGE_VAL : block_next_event(block, time);
        it->due = next < DBL_MAX ? next : DBL_MAX;
    }
    it->entered = time;
    it->moved = false;
    it->v = block->wanted.v;
    it->load = block->wanted.load;
    it->F_ext = block->wanted.F_ext;
    block->started = true;
    return ACCEPTED;
}

enum refusal continuous_read(const struct continuous *it, struct block *block,
                             enum reference reference, double *value)
{
    double rates[STATES];
    const struct settings *settings = &block->friction.settings;
    switch (reference) {
    case VR_x: *value = it->states[STATE_X]; break;
    case VR_x_dot: *value = it->states[STATE_X_DOT]; break;
    case VR_x_pull: *value = it->states[STATE_X] + extension(it); break;
    case VR_z: *value = extension(it); break;
    case VR_F: *value = settings->k * extension(it); break;
    case VR_F_s: *value = block->mode == 0 ? hold_of(it, block) : block->friction.F_s; break;
    case VR_F_friction:
        continuous_rates(it, block, rates);
        *value = settings->m * rates[STATE_X_DOT] - force_of(it, block);
        break;
    case VR_W_pull: *value = it->states[STATE_W_PULL]; break;
    case VR_Q_friction: *value = it->states[STATE_Q_FRICTION]; break;
    default: return block_read(block, reference, value);
    }
    return isfinite(*value) ? ACCEPTED : NOT_FINITE;
}
