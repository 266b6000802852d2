#include "block.h"

#include <float.h>
#include <math.h>

/* After every so many transitions the rest of a step is estimated from the part that is done. */
enum { TRANSITIONS_TO_ESTIMATE = 4096 };

/* How many arcs a slip may still have for its end to be told. */
enum { ARCS_TO_LOOK_AHEAD = 64 };

static const struct sum ZERO = {0.0, 0.0};

/* No step moves along the arc alone: none was made yet, or settings changed. */
static const double NO_HORIZON = -HUGE_VAL;

static const struct arc_functions *functions_of(const struct arc *arc)
{
    return ARCS[arc->tag];
}

enum refusal normal_force(const struct settings *settings, double *normal)
{
    const double weight = settings->m * settings->g;
    *normal = weight + settings->load;
    return settings->load >= -weight ? ACCEPTED : LIFTED_OFF;
}

/* Time along the arc [s], which at an event that is due may be a rounding beyond its end. */
static double tau_of(const struct block *block)
{
    const double tau = block->elapsed.high;
    return tau < block->arc.duration ? tau : block->arc.duration;
}

/* Time that the mass has been at rest [s]. */
static double age_of(const struct block *block)
{
    return block->arc.mode == 0 ? block->arc.age + tau_of(block) : 0.0;
}

/* Let the settings last set act. */
static enum refusal adopt_settings(struct block *block, const struct friction *before)
{
    const enum refusal refused = LAW.under(&block->friction, &block->wanted, before);
    block->F_s = block->friction.F_s;
    return refused;
}

/* Stand at the start of the arc. */
static void stand_at_start(struct block *block)
{
    block->elapsed = ZERO;
    block->mode = block->arc.mode;
}

/* Add the arc up to tau, where its motion is given, to the sums and the meter. */
static void bank(struct block *block, double tau, struct motion motion)
{
    const struct arc *arc = &block->arc;
    const struct arc_functions *functions = functions_of(arc);
    const double displacement = motion.displacement;
    block->x_start = sum_with(block->x_start, displacement);
    block->W_pull = sum_with(block->W_pull, functions->pull_work(arc, tau));
    block->Q_friction = sum_with(block->Q_friction, functions->heat(arc, tau, displacement));
    if (arc->mode == 0)
        meter_pass_stick(&block->meter, tau);
    else
        meter_pass_slip(&block->meter, tau, displacement, -motion.growth,
                        functions->extreme_velocity(arc, tau));
    block->z = arc->z_start + motion.growth;
}

size_t block_size(void)
{
    return sizeof(struct block);
}

enum refusal block_start(struct block *block, const struct settings *settings, double start_time)
{
    *block = (struct block){.wanted = *settings, .horizon = NO_HORIZON};
    block->x_start.high = settings->x_start;
    meter_start(&block->meter, start_time);
    enum refusal refused = adopt_settings(block, NULL);
    if (refused != ACCEPTED) return refused;
    const double x_dot = settings->x_dot_start;
    const int mode = x_dot == 0.0 ? 0 : x_dot > 0.0 ? 1 : -1;
    refused = LAW.begin(&block->friction, mode, settings->z_start, x_dot,
                        block->friction.age_start, NULL, &block->arc);
    if (refused != ACCEPTED) return refused;
    stand_at_start(block);
    return block_refresh(block);
}

void block_set(struct block *block, enum reference reference, double value)
{
    double *wanted = (double *)((char *)&block->wanted + ROWS[reference].offset);
    if (*wanted != value) {
        *wanted = value;
        block->changed = true;
        block->horizon = NO_HORIZON;
    }
}

enum refusal block_check(const struct block *block)
{
    double normal;
    return normal_force(&block->wanted, &normal);
}

enum refusal block_refresh(struct block *block)
{
    const struct settings *settings = &block->friction.settings;
    const struct arc *arc = &block->arc;
    const struct motion motion = functions_of(arc)->state(arc, tau_of(block));
    block->x_dot = motion.x_dot;
    block->z = arc->z_start + motion.growth;
    block->x = block->x_start.high + (block->x_start.low + motion.displacement);
    block->x_pull = block->x + block->z;
    block->F = settings->k * block->z;
    block->F_friction = motion.balance ? 0.0 - (block->F + settings->F_ext) : motion.friction;
    block->mode = arc->mode;
    if (block->friction.varies) block->F_s = LAW.hold(&block->friction, age_of(block));
    block->own = motion.own;
    block->displacement = motion.displacement;
    block->stale = false;
    const bool finite = fabs(block->x_pull + block->F) <= DBL_MAX && block->F_s <= DBL_MAX;
    return finite ? ACCEPTED : NOT_FINITE;
}

/* Start a new arc under the settings last set, at this time [s], where the block stands. */
static enum refusal change_settings(struct block *block, double time)
{
    const struct arc arc = block->arc;
    const struct friction before = block->friction;
    const double tau = block->elapsed.high;
    const struct motion motion = functions_of(&arc)->state(&arc, tau);
    /* A mass that breaks away as the run starts has not moved before the first step. */
    const double age = block->started ? age_of(block) : before.age_start;
    const double x_dot = motion.x_dot;
    /* A slip of no length has not begun, so the rest test decides anew whether it does. */
    const bool at_rest = !LAW.whole && (arc.mode == 0 || (tau == 0.0 && x_dot == 0.0));
    enum refusal refused = adopt_settings(block, &before);
    if (refused != ACCEPTED) return refused;
    block->changed = false;
    /* What changed is not in the equation of slip, so the arc stays whole. */
    if (!at_rest && LAW.same_slip(&block->friction, &before)) return ACCEPTED;
    bank(block, tau, motion);
    const double z = block->z;
    const double dk = block->friction.settings.k - before.settings.k;
    block->W_k = sum_with(block->W_k, 0.5 * (dk * z) * z);
    refused = LAW.begin(&block->friction, at_rest ? 0 : arc.mode, z, x_dot, age, &motion.own,
                        &block->arc);
    if (refused != ACCEPTED) return refused;
    stand_at_start(block);
    if (block->started && arc.mode == 0 && block->mode != 0)
        meter_break_away(&block->meter, time);
    return ACCEPTED;
}

/* Go through the end of the arc, at this time [s], into the next one. */
static enum refusal pass_event(struct block *block, double time)
{
    const struct arc ended = block->arc;
    bank(block, ended.duration, functions_of(&ended)->end(&ended));
    const enum refusal refused = LAW.after(&block->friction, &ended, block->z, &block->arc);
    if (refused != ACCEPTED) return refused;
    if (block->arc.mode != ended.mode) {
        if (ended.mode == 0)
            meter_break_away(&block->meter, time);
        else
            meter_end_slip(&block->meter, time);
    }
    stand_at_start(block);
    return ACCEPTED;
}

/* Whether a step of which `done` [s] already held so many transitions has an end. */
static bool keeps_pace(long transitions, double step, double done)
{
    return (double)transitions <= (double)MOST_TRANSITIONS * (done / step);
}

/* Let settings last set act, and the run begin, at this time [s]. */
static enum refusal begin(struct block *block, double time)
{
    if (block->changed) {
        const enum refusal refused = change_settings(block, time);
        if (refused != ACCEPTED) return refused;
    }
    if (!block->started) {
        block->started = true;
        if (block->mode != 0 && block->arc.x_dot_start == 0.0)
            meter_break_away(&block->meter, time);
    }
    return ACCEPTED;
}

/* Whether an arc is over after this time along it; `left` is the time since then [s]. A stick ends
 * when time passes its end, a slip when time reaches it: (1). */
static bool is_over(const struct arc *arc, struct sum elapsed, struct sum *left)
{
    if (!(elapsed.high >= arc->duration)) return false;
    *left = sum_with(elapsed, -arc->duration);
    return left->high > 0.0 || (left->high == 0.0 && arc->mode != 0);
}

/* Time along the arc at `then` [s], where it is `elapsed` at time + step. */
static struct sum elapsed_at(struct sum elapsed, double time, double step, double then)
{
    const struct sum since = sum_with(sum_with((struct sum){then, 0.0}, -time), -step);
    return sum_with(sum_with(elapsed, since.high), since.low);
}

/* The first time at which the arc is over, to a rounding of times along it; it is `elapsed` at
 * time + step [s]. */
static double time_over(const struct arc *arc, struct sum elapsed, double time, double step)
{
    struct sum left = sum_with(elapsed, -arc->duration);
    struct sum exact = sum_with((struct sum){time, 0.0}, step);
    exact = sum_with(sum_with(exact, -left.high), -left.low);
    double then = exact.high, more = 0.0;
    while (!is_over(arc, elapsed_at(elapsed, time, step, then + more), &left))
        more = more > 0.0 ? 2.0 * more : nextafter(then, HUGE_VAL) - then;
    return then + more;
}

/* Move on by one step that may begin with other settings or hold transitions; no further than to
 * the first change of mode where `stop` is not NULL. */
static enum refusal advance_through(struct block *block, double time, double step,
                                    struct stop *stop)
{
    if (!(0.0 < step && step <= DBL_MAX)) return STEP_OUT_OF_RANGE;
    if (!isfinite(time)) return TIME_OUT_OF_RANGE;
    const struct block entry = *block;
    struct block before;
    if (block->changed || !block->started) {
        const enum refusal refused = begin(block, time);
        if (refused != ACCEPTED) return refused;
        if (stop != NULL && block->mode != entry.mode) {
            *block = entry;
            *stop = (struct stop){.time = time, .event = true};
            return ACCEPTED;
        }
    }
    struct sum elapsed = sum_with(block->elapsed, step), left;
    long transitions = 0;
    while (is_over(&block->arc, elapsed, &left)) {
        const double then = time + (step - left.high);
        if (stop != NULL) before = *block;
        const enum refusal refused = pass_event(block, then);
        if (refused != ACCEPTED) return refused;
        if (stop != NULL && block->mode != before.mode) {
            *block = before;
            stop->event = true;
            const double over = time_over(&block->arc, elapsed, time, step);
            if (over < stop->time) {
                elapsed = elapsed_at(elapsed, time, step, over);
                stop->time = over;
            }
            break;
        }
        elapsed = left;
        transitions++;
        if (transitions % TRANSITIONS_TO_ESTIMATE == 0 &&
            !keeps_pace(transitions, step, step - left.high)) {
            *block = entry;
            return TOO_MANY_TRANSITIONS;
        }
    }
    block->elapsed = elapsed;
    block->horizon = block->arc.duration;
    block->stale = true;
    return ACCEPTED;
}

enum refusal block_advance(struct block *block, double time, double step)
{
    const double elapsed = block->elapsed.high;
    const double total = elapsed + step;
    if (!block->started && !block->changed && block->mode == 0) {
        block->started = true;
        block->horizon = block->arc.duration;
    }
    if (total < block->horizon && step > 0.0 && isfinite(time)) {
        /* sum_with, written out: nearly every step ends here. */
        const double shadow = total - elapsed;
        const double low =
            block->elapsed.low + ((elapsed - (total - shadow)) + (step - shadow));
        const double high = total + low;
        block->elapsed = (struct sum){high, low - (high - total)};
        block->stale = true;
        return ACCEPTED;
    }
    return advance_through(block, time, step, NULL);
}

enum refusal block_advance_to_event(struct block *block, double time, double step,
                                    struct stop *stop)
{
    *stop = (struct stop){.time = time + step};
    return advance_through(block, time, step, stop);
}

enum refusal block_lift(struct block *block, double time, double *age)
{
    const enum refusal refused = begin(block, time);
    if (refused != ACCEPTED) return refused;
    *age = age_of(block);
    const enum refusal left = block_refresh(block);
    bank(block, tau_of(block), functions_of(&block->arc)->state(&block->arc, tau_of(block)));
    return left;
}

enum refusal block_land(struct block *block, double time, int mode, double z, double x_dot,
                        double age)
{
    const struct friction before = block->friction;
    enum refusal refused = adopt_settings(block, &before);
    if (refused == ACCEPTED)
        refused = LAW.begin(&block->friction, mode, z, x_dot, age, NULL, &block->arc);
    if (refused != ACCEPTED) return refused;
    stand_at_start(block);
    if (mode == 0 && block->mode != 0) meter_break_away(&block->meter, time);
    block->changed = false;
    block->horizon = block->arc.duration;
    return block_refresh(block);
}

enum refusal block_settle(struct block *block, double time)
{
    struct sum left;
    for (int passed = 0; is_over(&block->arc, block->elapsed, &left); passed++) {
        if (passed == TRANSITIONS_TO_ESTIMATE) return TOO_MANY_TRANSITIONS;
        const enum refusal refused = pass_event(block, time - left.high);
        if (refused != ACCEPTED) return refused;
        block->elapsed = left;
    }
    /* What is set where an arc begins acts on its beginning, not a rounding later. */
    if (block->changed && block->elapsed.high <= 2.0 * DBL_EPSILON * fabs(time))
        block->elapsed = ZERO;
    const enum refusal refused = begin(block, time);
    if (refused != ACCEPTED) return refused;
    block->horizon = block->arc.duration;
    return block_refresh(block);
}

double block_next_event(const struct block *block, double time)
{
    struct block next = *block;
    struct sum elapsed = block->elapsed;
    for (int arcs = 0; arcs < ARCS_TO_LOOK_AHEAD && !block->changed; arcs++) {
        const struct arc arc = next.arc;
        if (arc.duration > DBL_MAX || pass_event(&next, time) != ACCEPTED) break;
        if (next.mode != block->mode)
            return time_over(&arc, elapsed, time, 0.0);
        elapsed = sum_with(elapsed, -arc.duration);
    }
    return HUGE_VAL;
}

/* An energy that grew since the start of the arc [J]. */
static enum refusal energy(struct sum before, double since, double *value)
{
    *value = before.high + (before.low + since);
    return isfinite(*value) ? ACCEPTED : NOT_FINITE;
}

/* The mode for the outputs: of a law without a stick one below a speed. */
static int shown_mode(const struct block *block)
{
    if (!LAW.whole) return block->mode;
    if (fabs(block->x_dot) < block->friction.v_stick || block->x_dot == 0.0) return 0;
    return block->x_dot > 0.0 ? 1 : -1;
}

enum refusal block_read(struct block *block, enum reference reference, double *value)
{
    if (ROWS[reference].settable) {
        *value = *(const double *)((const char *)&block->wanted + ROWS[reference].offset);
        return ACCEPTED;
    }
    if (block->stale) {
        const enum refusal refused = block_refresh(block);
        if (refused != ACCEPTED) return refused;
    }
    const struct meter *meter = &block->meter;
    const struct arc *arc = &block->arc;
    switch (reference) {
    case VR_x: *value = block->x; break;
    case VR_x_dot: *value = block->x_dot; break;
    case VR_x_pull: *value = block->x_pull; break;
    case VR_z: *value = block->z; break;
    case VR_F: *value = block->F; break;
    case VR_F_friction: *value = block->F_friction; break;
    case VR_F_s: *value = block->F_s; break;
    case VR_sticking: *value = shown_mode(block) == 0 ? 1.0 : 0.0; break;
    case VR_mode: *value = shown_mode(block); break;
    case VR_delta_x: *value = meter->delta_x; break;
    case VR_spring_drop: *value = meter->spring_drop; break;
    case VR_t_stick: *value = meter->t_stick; break;
    case VR_t_slip: *value = meter->t_slip; break;
    case VR_T: *value = meter->T; break;
    case VR_f: *value = meter_frequency(meter); break;
    case VR_x_dot_peak: *value = meter->x_dot_peak; break;
    case VR_n_slips: *value = meter->n_slips; break;
    case VR_t_event: *value = meter->t_event; break;
    case VR_W_pull:
        return energy(block->W_pull, functions_of(arc)->pull_work(arc, tau_of(block)), value);
    case VR_W_k:
        *value = block->W_k.high;
        return isfinite(*value) ? ACCEPTED : NOT_FINITE;
    case VR_Q_friction:
        return energy(block->Q_friction,
                      functions_of(arc)->heat(arc, tau_of(block), block->displacement), value);
    default: *value = LAW.output(&block->friction, &block->own, block->x_dot, reference); break;
    }
    return ACCEPTED;
}

void block_save(const struct block *block, struct block_state *saved)
{
    *saved = (struct block_state){
        .wanted = block->wanted,
        .settings = block->friction.settings,
        .elapsed = block->elapsed,
        .x_start = block->x_start,
        .W_pull = block->W_pull,
        .W_k = block->W_k,
        .Q_friction = block->Q_friction,
        .meter = block->meter,
        .started = block->started,
        .changed = block->changed,
    };
    functions_of(&block->arc)->start(&block->arc, &saved->start);
}

/* Whether a block can reach these values, each of them finite. */
static bool reachable(const struct block_state *saved)
{
    const struct start *start = &saved->start;
    const struct meter *meter = &saved->meter;
    const struct sum sums[] = {
        saved->elapsed, saved->x_start, saved->W_pull,       saved->W_k,    saved->Q_friction,
        meter->phase,   meter->cycle,   meter->displacement, meter->relief,
    };
    for (size_t n = 0; n < sizeof sums / sizeof *sums; n++)
        if (!is_sum(sums[n])) return false;
    return -1 <= start->mode && start->mode <= 1 && (start->mode == 0 || start->known) &&
           start->age >= 0.0 && saved->elapsed.high >= 0.0 && meter->n_slips >= 0 &&
           meter->t_slip >= 0.0 && meter->t_stick >= 0.0 && meter->T >= 0.0 &&
           (LAW.whole || saved->Q_friction.high >= 0.0);
}

enum refusal block_restore(struct block *block, const struct block_state *saved)
{
    if (!reachable(saved)) return NO_SUCH_STATE;
    struct block made = {
        .wanted = saved->settings,
        .elapsed = saved->elapsed,
        .x_start = saved->x_start,
        .W_pull = saved->W_pull,
        .W_k = saved->W_k,
        .Q_friction = saved->Q_friction,
        .meter = saved->meter,
        .started = saved->started,
        .changed = saved->changed,
        .horizon = NO_HORIZON,
    };
    enum refusal refused = adopt_settings(&made, NULL);
    if (refused != ACCEPTED) return refused;
    made.wanted = saved->wanted;
    refused = LAW.arc(&made.friction, &saved->start, &made.arc);
    if (refused != ACCEPTED) return refused;
    if (made.started && !made.changed) made.horizon = made.arc.duration;
    refused = block_refresh(&made);
    if (refused == ACCEPTED) *block = made;
    return refused;
}
