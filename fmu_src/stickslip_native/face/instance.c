/* What both FMI versions share: see the header. */
#include "instance.h"

#include "bytes.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *const PHASE_NAMES[PHASES] = {
    "instantiated",
    "initialization",
    "stepping",
    "stepping, with an event to handle",
    "event mode",
    "continuous time",
    "terminated",
};

/* A state that the simulator holds, or held: its mark is that of the FMU, or the complement. */
struct state {
    uint64_t mark;
    struct state *next; /* of the freed ones, from the oldest on */
    struct situation kept;
};

/* Messages. */

void instance_tell(const struct instance *it, enum status status, const char *text)
{
    const bool warning = status == STATUS_WARNING;
    if (it->logger == NULL || !(warning ? it->logs_warnings : it->logs_errors)) return;
    it->version->log(it, status, warning ? "logStatusWarning" : "logStatusError", text);
}

bool instance_fail(struct instance *it, const char *reason)
{
    if (!it->failed) {
        it->failed = true;
        it->ready = false;
        snprintf(it->fault, sizeof it->fault, "%s", reason);
    }
    instance_tell(it, STATUS_ERROR, it->fault);
    return false;
}

/* Whether the instance can be called: it is none that failed. */
static bool sound(struct instance *it)
{
    if (it == NULL) return false;
    return it->failed ? instance_fail(it, it->fault) : true;
}

static bool refuse(struct instance *it, enum refusal refusal, double time, double step)
{
    char reason[MESSAGE_SIZE];
    refusal_text(refusal, &it->now.block.wanted, time, step, reason);
    return instance_fail(it, reason);
}

static bool require(struct instance *it, enum phase phase, const char *call)
{
    char reason[MESSAGE_SIZE];
    if (it->now.phase == phase) return true;
    snprintf(reason, sizeof reason, "%s is not allowed here: the instance is in phase %s", call,
             PHASE_NAMES[it->now.phase]);
    return instance_fail(it, reason);
}

bool instance_absent(struct instance *it, const char *call)
{
    char reason[MESSAGE_SIZE];
    if (!sound(it)) return false;
    snprintf(reason, sizeof reason,
             "%s is not allowed here: this is %s", call,
             it->solves ? "model exchange" : "co-simulation without clocks");
    return instance_fail(it, reason);
}

bool instance_unsupported(const struct instance *it, const char *call)
{
    char reason[MESSAGE_SIZE];
    if (it == NULL) return false;
    snprintf(reason, sizeof reason, "FMI function not supported: %s", call);
    instance_tell(it, STATUS_ERROR, reason);
    return false;
}

bool instance_given(struct instance *it, const char *call, const char *name, const void *argument)
{
    char reason[MESSAGE_SIZE];
    if (argument != NULL) return true;
    snprintf(reason, sizeof reason, "%s: %s is NULL", call, name);
    return instance_fail(it, reason);
}

bool instance_log(struct instance *it, const char *call, bool on, size_t count,
                  const char *const categories[])
{
    bool warnings = on && count == 0, errors = on && count == 0;
    if (it == NULL) return false;
    if (count > 0 && !instance_given(it, call, "categories", categories)) return false;
    for (size_t n = 0; n < count; n++) {
        if (!instance_given(it, call, "a category", categories[n])) return false;
        const bool all = strcmp(categories[n], "logAll") == 0;
        if (on && (all || strcmp(categories[n], "logStatusWarning") == 0)) warnings = true;
        if (on && (all || strcmp(categories[n], "logStatusError") == 0)) errors = true;
    }
    it->logs_warnings = warnings;
    it->logs_errors = errors;
    return true;
}

/* Tell the remarks of the friction law, unless they were the last ones told. */
static void warn(struct instance *it)
{
    char text[MESSAGE_SIZE];
    struct remark remarks[MOST_REMARKS];
    const int count = LAW.remarks(&it->now.block.wanted, remarks);
    bool told = count == it->warned;
    for (int n = 0; n < count && told; n++) told = same_remark(&remarks[n], &it->warned_of[n]);
    if (told) return;
    it->warned = count;
    if (count == 0) return;
    for (int n = 0; n < count; n++) it->warned_of[n] = remarks[n];
    remarks_text(remarks, count, text);
    instance_tell(it, STATUS_WARNING, text);
}

/* Instances and phases. */

static double *value_of(struct settings *settings, const struct row *row)
{
    return (double *)((char *)settings + row->offset);
}

/* Start the block with the values set. */
static bool start_block(struct instance *it)
{
    const enum refusal refused = block_start(&it->now.block, &it->now.block.wanted, it->now.time);
    it->now.settled = refused == ACCEPTED;
    return it->now.settled || refuse(it, refused, 0.0, 0.0);
}

/* Whether values that are set act from the next step or event on. */
static bool running(const struct instance *it)
{
    return STEPPING <= it->now.phase && it->now.phase <= CONTINUOUS;
}

/* Read the discrete outputs of the block. */
static bool read_discrete(struct instance *it, double values[DISCRETE])
{
    for (int n = 0; n < VARIABLES; n++) {
        if (ROWS[n].discrete < 0) continue;
        const enum refusal refused =
            block_read(&it->now.block, (enum reference)n, &values[ROWS[n].discrete]);
        if (refused != ACCEPTED) return refuse(it, refused, 0.0, 0.0);
    }
    return true;
}

/* Hold the discrete outputs as they are now. */
static bool hold_discrete(struct instance *it)
{
    return read_discrete(it, it->now.of.held);
}

bool instance_reset(struct instance *it)
{
    if (it == NULL) return false;
    for (int n = 0; n < VARIABLES; n++)
        if (ROWS[n].settable) *value_of(&it->now.block.wanted, &ROWS[n]) = ROWS[n].start;
    it->now.time = 0.0;
    it->now.phase = INSTANTIATED;
    it->ready = it->failed = false;
    it->warned = 0;
    it->now.holds = false;
    it->now.solved = it->now.moves = false;
    memset(it->now.rates, 0, sizeof it->now.rates);
    memset(it->gathered, 0, sizeof it->gathered);
    return start_block(it);
}

struct instance *instance_make(const struct version *version, const char *call, const char *name,
                               const char *identity, const char *identity_given,
                               void (*logger)(void), void *environment)
{
    char reason[MESSAGE_SIZE];
    const struct instance none = {
        .version = version,
        .logger = logger,
        .environment = environment,
        .name = name == NULL ? "" : name,
        .logs_warnings = true,
        .logs_errors = true,
    };
    const size_t length = strlen(none.name) + 1;
    struct instance *made = NULL;

    if (name == NULL) {
        snprintf(reason, sizeof reason, "%s: the instance name is NULL", call);
    } else if (identity_given == NULL) {
        snprintf(reason, sizeof reason, "%s: the %s is NULL", call, version->identity_name);
    } else if (strcmp(identity_given, identity) != 0) {
        snprintf(reason, sizeof reason, "%s: the %s is %.80s, and that of this FMU is %.80s", call,
                 version->identity_name, identity_given, identity);
    } else {
        snprintf(reason, sizeof reason, "%s: out of memory", call);
        made = calloc(1, sizeof *made + length);
    }
    if (made == NULL) {
        instance_tell(&none, STATUS_ERROR, reason);
        return NULL;
    }
    *made = none;
    made->name = memcpy(made + 1, none.name, length);
    made->mark = hash_of(identity, strlen(identity));
    instance_reset(made);
    return made;
}

void instance_free(struct instance *it)
{
    if (it == NULL) return;
    while (it->oldest_freed != NULL) {
        struct state *state = it->oldest_freed;
        it->oldest_freed = state->next;
        free(state);
    }
    free(it);
}

bool instance_set_start(struct instance *it, double start_time)
{
    char number[NUMBER_SIZE], reason[MESSAGE_SIZE];
    if (!sound(it)) return false;
    if (!isfinite(start_time)) {
        number_text(start_time, number);
        snprintf(reason, sizeof reason, "start time = %s s is out of range: a finite number",
                 number);
        return instance_fail(it, reason);
    }
    if (!require(it, INSTANTIATED, "setupExperiment")) return false;
    it->now.time = start_time;
    it->now.settled = false;
    return true;
}

bool instance_enter_initialization(struct instance *it)
{
    if (!sound(it) || !require(it, INSTANTIATED, "enterInitializationMode")) return false;
    it->now.phase = INITIALIZATION;
    return true;
}

bool instance_exit_initialization(struct instance *it)
{
    if (!sound(it) || !require(it, INITIALIZATION, "exitInitializationMode")) return false;
    if (!start_block(it)) return false;
    it->now.phase = it->has_events || it->solves ? EVENT_MODE : STEPPING;
    it->now.holds = it->has_events;
    it->now.solved = it->solves;
    if (it->solves) continuous_start(&it->now.of.solver, &it->now.block, it->now.time);
    warn(it);
    return !it->has_events || hold_discrete(it);
}

bool instance_terminate(struct instance *it)
{
    if (!sound(it)) return false;
    it->now.phase = TERMINATED;
    it->ready = false;
    return true;
}

/* Check the phase and warn; no call but another one between two steps can change either. */
static bool prepare_step(struct instance *it)
{
    if (!sound(it) || !require(it, STEPPING, "doStep")) return false;
    warn(it);
    it->ready = !it->now.moves;
    return true;
}

bool instance_moves(uint32_t reference, int *position)
{
    for (*position = 0; *position < MOVING; ++*position)
        if (reference == MOVES[*position]) return !LAW.whole;
    return false;
}

bool instance_set_rates(struct instance *it, const char *call, const uint32_t references[],
                        size_t count, const int orders[], const double values[])
{
    char reason[MESSAGE_SIZE];
    int position;
    if (!sound(it)) return false;
    if (count > 0 && (!instance_given(it, call, "the list of value references", references) ||
                      !instance_given(it, call, "the list of orders", orders) ||
                      !instance_given(it, call, "the list of values", values)))
        return false;
    for (size_t n = 0; n < count; n++) {
        if (!instance_moves(references[n], &position) || orders[n] != 1 || !isfinite(values[n])) {
            snprintf(reason, sizeof reason,
                     LAW.whole ? "%s: inputs are held over a step under this friction law"
                               : "%s: v, load and F_ext have a derivative, of order 1 and finite",
                     call);
            return instance_fail(it, reason);
        }
        it->now.rates[position] = values[n];
        it->now.moves = true;
        it->ready = false;
    }
    return true;
}

/* Move the block by a step, with the inputs. */
static enum refusal advance(struct instance *it, double time, double step)
{
    double ends[MOVING];
    bool moving = false;
    if (it->ready) return block_advance(&it->now.block, time, step);
    for (int n = 0; n < MOVING; n++) {
        const double from = *value_of(&it->now.block.wanted, &ROWS[MOVES[n]]);
        ends[n] = it->gathered[n] ? it->ends[n] : from + it->now.rates[n] * step;
        moving = moving || ends[n] != from;
    }
    /* A rate cannot name the load that lifts the mass but to rounding. */
    const double weight = it->now.block.wanted.m * it->now.block.wanted.g;
    if (!it->gathered[1] && fabs(ends[1] + weight) <= 8.0 * DBL_EPSILON * weight) ends[1] = -weight;
    /* Inputs that stay keep the arc whole. */
    const enum refusal refused = moving ? ramp_advance(&it->now.block, time, step, ends)
                                        : block_advance(&it->now.block, time, step);
    if (refused != ACCEPTED) return refused;
    it->now.moves = false;
    memset(it->now.rates, 0, sizeof it->now.rates);
    memset(it->gathered, 0, sizeof it->gathered);
    return ACCEPTED;
}

/* Refuse a step, or discard it. */
static enum status refuse_step(struct instance *it, enum refusal refused, double time, double step)
{
    char reason[MESSAGE_SIZE];
    if (refused != TOO_MANY_TRANSITIONS) {
        refuse(it, refused, time, step);
        return STATUS_ERROR;
    }
    refusal_text(refused, &it->now.block.wanted, time, step, reason);
    instance_tell(it, STATUS_DISCARD, reason);
    return STATUS_DISCARD;
}

/* A state holds no time beyond the numbers. */
static double within_numbers(double time)
{
    return time > DBL_MAX ? DBL_MAX : time;
}

enum status instance_step(struct instance *it, double time, double step)
{
    if (it == NULL || (!it->ready && !prepare_step(it))) return STATUS_ERROR;
    const enum refusal refused = advance(it, time, step);
    if (refused != ACCEPTED) return refuse_step(it, refused, time, step);
    it->now.time = within_numbers(time + step);
    return STATUS_OK;
}

enum status instance_step_to_event(struct instance *it, double time, double step, bool *event,
                                   bool *early)
{
    struct stop stop = {.time = time + step};
    if (!it->ready && !prepare_step(it)) return STATUS_ERROR;
    /* A step in which inputs move is completed. */
    enum refusal refused = it->stops && it->ready
                               ? block_advance_to_event(&it->now.block, time, step, &stop)
                               : advance(it, time, step);
    if (refused == ACCEPTED && stop.event && !it->has_events)
        refused = block_settle(&it->now.block, stop.time);
    if (refused != ACCEPTED) return refuse_step(it, refused, time, step);
    *early = stop.time < time + step;
    it->now.time = within_numbers(stop.time);
    if (!it->has_events) return STATUS_OK;
    double values[DISCRETE];
    if (!read_discrete(it, values)) return STATUS_ERROR;
    *event = stop.event || memcmp(values, it->now.of.held, sizeof values) != 0;
    if (*event) {
        it->now.phase = EVENT_DUE;
        it->ready = false;
    }
    return STATUS_OK;
}

bool instance_enter_event_mode(struct instance *it, const char *call)
{
    char reason[MESSAGE_SIZE];
    if (!sound(it)) return false;
    if (!it->solves && !it->has_events) {
        snprintf(reason, sizeof reason,
                 "%s is not allowed here: the instance was made without event mode", call);
        return instance_fail(it, reason);
    }
    if (it->now.phase != EVENT_DUE && !require(it, it->solves ? CONTINUOUS : STEPPING, call))
        return false;
    it->now.phase = EVENT_MODE;
    it->ready = false;
    return true;
}

/* Go through all that is due in event mode. */
static bool settle(struct instance *it, const char *call)
{
    if (!sound(it) || !require(it, EVENT_MODE, call)) return false;
    const enum refusal refused = it->now.solved
                                     ? continuous_update(&it->now.of.solver, &it->now.block)
                                     : block_settle(&it->now.block, it->now.time);
    if (refused != ACCEPTED) return refuse(it, refused, it->now.time, 0.0);
    warn(it);
    return it->now.solved || hold_discrete(it);
}

bool instance_update(struct instance *it, const char *call, double *next_event)
{
    if (!settle(it, call)) return false;
    *next_event = it->now.solved ? it->now.of.solver.due
                                 : block_next_event(&it->now.block, it->now.time);
    return true;
}

bool instance_enter_step_mode(struct instance *it)
{
    if (it != NULL && it->solves) return instance_absent(it, "fmi3EnterStepMode");
    if (!settle(it, "fmi3EnterStepMode")) return false;
    it->now.phase = STEPPING;
    return true;
}

/* Values. */

/* Let inputs that moved act, in continuous time. */
static enum refusal adopt(struct instance *it)
{
    return it->now.phase == CONTINUOUS ? continuous_adopt(&it->now.block) : ACCEPTED;
}

/* The block under the settings last set, which in event mode act on what is read and no more. */
static struct block *acting(struct instance *it, struct block *scratch)
{
    if (it->now.phase != EVENT_MODE || !it->now.block.changed) return &it->now.block;
    *scratch = it->now.block;
    return continuous_adopt(scratch) == ACCEPTED ? scratch : &it->now.block;
}

static enum sort sort_of(const struct row *row)
{
    if (row->enumeration) return SORT_ENUMERATION;
    return row->kind == REAL ? SORT_REAL : row->kind == INTEGER ? SORT_INTEGER : SORT_BOOLEAN;
}

/* Whether there is a variable with this reference, and of this type. */
static bool has(const struct type *type, uint32_t reference)
{
    return reference < VARIABLES && (type->sorts >> sort_of(&ROWS[reference]) & 1u) != 0;
}

static bool is_time(const struct type *type, uint32_t reference)
{
    return type->has_time && reference == VARIABLES;
}

/* Derivatives and indicators have the references behind that of the time. */
static bool is_of_equations(const struct type *type, uint32_t reference)
{
    return type->has_time && reference > VARIABLES && reference < VARIABLES + STATES + INDICATORS;
}

/* The block as equations: as the solver has it, or where it stands. */
static struct continuous equations_of(const struct instance *it)
{
    struct continuous made;
    if (it->now.solved) return it->now.of.solver;
    continuous_start(&made, &it->now.block, it->now.time);
    made.entered = made.time - it->now.block.elapsed.high;
    return made;
}

static double of_equations(struct instance *it, uint32_t reference)
{
    double values[STATES + INDICATORS];
    struct block scratch;
    const struct continuous equations = equations_of(it);
    continuous_rates(&equations, acting(it, &scratch), values);
    continuous_indicators(&equations, acting(it, &scratch), values + STATES);
    return values[reference - VARIABLES];
}

static bool refuse_reference(struct instance *it, const struct type *type, uint32_t reference)
{
    char reason[MESSAGE_SIZE];
    if (reference < VARIABLES)
        snprintf(reason, sizeof reason, "%s is of type %s, not %s", ROWS[reference].name,
                 it->version->names[sort_of(&ROWS[reference])], type->name);
    else
        snprintf(reason, sizeof reason, "there is no variable with value reference %lu",
                 (unsigned long)reference);
    return instance_fail(it, reason);
}

/* Refuse to read: for a reference, or where all can be read for what the block says. */
static bool refuse_get(struct instance *it, const struct type *type, const uint32_t references[],
                       size_t count, enum refusal refusal)
{
    for (size_t n = 0; n < count; n++)
        if (!has(type, references[n]) && !is_time(type, references[n]) &&
            !is_of_equations(type, references[n]))
            return refuse_reference(it, type, references[n]);
    return refuse(it, refusal, 0.0, 0.0);
}

/* Check the lists of a call. */
static bool lists(struct instance *it, const char *call, const uint32_t references[], size_t count,
                  const void *values, size_t value_count)
{
    char reason[MESSAGE_SIZE];
    if (count > 0 && !instance_given(it, call, "the list of value references", references))
        return false;
    if (value_count > 0 && !instance_given(it, call, "the list of values", values)) return false;
    if (count == value_count) return true;
    snprintf(reason, sizeof reason, "%lu value references came with %lu values",
             (unsigned long)count, (unsigned long)value_count);
    return instance_fail(it, reason);
}

bool instance_begin_get(struct instance *it, const char *call, const struct type *type,
                        const uint32_t references[], size_t count, const void *values,
                        size_t value_count)
{
    if (!sound(it) || !lists(it, call, references, count, values, value_count)) return false;
    if (!it->now.settled && !start_block(it)) return false;
    if (!it->now.block.stale) return true;
    const enum refusal refused = block_refresh(&it->now.block);
    return refused == ACCEPTED || refuse_get(it, type, references, count, refused);
}

/* Read a variable of an instance that holds its discrete outputs, or that a solver moves. */
static enum refusal read_beside(struct instance *it, uint32_t reference, double *value)
{
    struct block scratch;
    const struct row *row = &ROWS[reference];
    if (it->now.solved && !row->settable) {
        const enum refusal refused = adopt(it);
        if (refused != ACCEPTED) return refused;
        return continuous_read(&it->now.of.solver, acting(it, &scratch), (enum reference)reference,
                               value);
    }
    if (row->discrete < 0) return block_read(&it->now.block, (enum reference)reference, value);
    *value = it->now.of.held[row->discrete];
    return ACCEPTED;
}

bool instance_get(struct instance *it, const struct type *type, const uint32_t references[],
                  size_t count, size_t position, double *value)
{
    const uint32_t reference = references[position];
    enum refusal refused = ACCEPTED;
    if (has(type, reference)) {
        refused = it->now.holds || it->now.solved
                      ? read_beside(it, reference, value)
                      : block_read(&it->now.block, (enum reference)reference, value);
        if (refused == ACCEPTED) return true;
    } else if (is_time(type, reference)) {
        *value = it->now.time;
        return true;
    } else if (is_of_equations(type, reference)) {
        refused = adopt(it);
        if (refused == ACCEPTED) {
            *value = of_equations(it, reference);
            return true;
        }
    }
    return refuse_get(it, type, references, count, refused);
}

bool instance_begin_set(struct instance *it, const char *call, const struct type *type,
                        const uint32_t references[], size_t count, const void *values,
                        size_t value_count)
{
    if (!sound(it)) return false;
    if (count > 0 && !instance_given(it, call, "the list of value references", references))
        return false;
    for (size_t n = 0; n < count; n++) {
        if (is_time(type, references[n]))
            return instance_fail(it, "time is the independent variable: it cannot be set");
        if (is_of_equations(type, references[n]))
            return instance_fail(it, "derivatives and indicators cannot be set");
    }
    return lists(it, call, references, count, values, value_count);
}

bool instance_set(struct instance *it, const struct type *type, uint32_t reference, double value)
{
    if (!has(type, reference)) return refuse_reference(it, type, reference);
    char reason[MESSAGE_SIZE];
    const struct row *row = &ROWS[reference];
    const bool runs = running(it);
    int position;
    double *kept = value_of(&it->now.block.wanted, row);

    if (it->now.phase == TERMINATED) {
        snprintf(reason, sizeof reason, "%s cannot be set: the simulation is terminated",
                 row->name);
        return instance_fail(it, reason);
    }
    if (it->now.solved && it->now.phase == CONTINUOUS) {
        /* Some importers set states one by one. */
        static const enum reference STATE_ROWS[STATES] = {VR_x, VR_x_dot, VR_z, VR_W_pull,
                                                          VR_Q_friction};
        for (int n = 0; n < STATES; n++)
            if (reference == (uint32_t)STATE_ROWS[n] && isfinite(value)) {
                it->now.of.solver.states[n] = value;
                return true;
            }
    }
    if (!row->settable) {
        /* Before the start an importer may write back the start values that it read. */
        if (!runs && row->has_start && value == row->start) return true;
        snprintf(reason, sizeof reason, "%s is an output: it cannot be set", row->name);
        return instance_fail(it, reason);
    }
    if (runs && row->fixed) {
        if (value == *kept) return true;
        snprintf(reason, sizeof reason, "%s is fixed: it cannot change after initialization",
                 row->name);
        return instance_fail(it, reason);
    }
    if (!in_range(row, value)) {
        range_text(row, value, reason);
        return instance_fail(it, reason);
    }
    if (runs && row->tunable && (it->has_events || it->solves) && it->now.phase != EVENT_MODE) {
        if (value == *kept) return true;
        snprintf(reason, sizeof reason, "%s is tunable: it can change in event mode", row->name);
        return instance_fail(it, reason);
    }
    if (it->gathers) {
        if (!instance_moves(reference, &position)) {
            snprintf(reason, sizeof reason, "%s cannot be set in an intermediate update", row->name);
            return instance_fail(it, reason);
        }
        it->ends[position] = value;
        it->gathered[position] = it->now.moves = true;
        it->ready = false;
    } else if (!runs) {
        *kept = value;
        it->now.settled = false;
    } else if (value != *kept) {
        block_set(&it->now.block, (enum reference)reference, value);
        if (it->now.phase == CONTINUOUS) continuous_note(&it->now.of.solver, &it->now.block);
    }
    return true;
}

bool instance_end_set(struct instance *it)
{
    if (!running(it) || it->gathers) return true;
    /* Whether there is something to warn of shows when all values for a step are set. */
    it->ready = false;
    const enum refusal refused = block_check(&it->now.block);
    return refused == ACCEPTED || refuse(it, refused, 0.0, 0.0);
}

/* Model exchange. */

/* Whether an instance is one for model exchange, where such a call is. */
static bool solving(struct instance *it, const char *call)
{
    return it != NULL && it->solves ? sound(it) : it != NULL && instance_absent(it, call);
}

bool instance_enter_continuous(struct instance *it, const char *call)
{
    if (!solving(it, call) || !settle(it, call)) return false;
    it->now.phase = CONTINUOUS;
    return true;
}

bool instance_set_time(struct instance *it, const char *call, double time)
{
    if (!solving(it, call) || !require(it, CONTINUOUS, call)) return false;
    if (!isfinite(time)) return refuse(it, TIME_OUT_OF_RANGE, time, 0.0);
    it->now.time = it->now.of.solver.time = time;
    return true;
}

bool instance_complete_step(struct instance *it, const char *call)
{
    return solving(it, call) && require(it, CONTINUOUS, call);
}

/* Check an array of a call of model exchange, and let inputs that moved act. */
static bool array(struct instance *it, const char *call, const void *values, size_t count,
                  size_t expected)
{
    char reason[MESSAGE_SIZE];
    if (!solving(it, call) || !instance_given(it, call, "the list of values", values))
        return false;
    it->discards = false;
    if (count != expected) {
        snprintf(reason, sizeof reason, "%s: there are %lu values, not %lu", call,
                 (unsigned long)expected, (unsigned long)count);
        return instance_fail(it, reason);
    }
    if (!it->now.settled && !start_block(it)) return false;
    const enum refusal refused = adopt(it);
    return refused == ACCEPTED || refuse(it, refused, 0.0, 0.0);
}

/* Whether all values are finite; if not the call is discarded, and a solver may try others. */
static bool all_finite(struct instance *it, const char *call, const double values[], size_t count)
{
    char reason[MESSAGE_SIZE];
    for (size_t n = 0; n < count; n++)
        if (!isfinite(values[n])) it->discards = true;
    if (!it->discards) return true;
    snprintf(reason, sizeof reason, "%s: a value is not finite", call);
    instance_tell(it, STATUS_DISCARD, reason);
    return false;
}

bool instance_get_states(struct instance *it, const char *call, double values[], size_t count)
{
    if (!array(it, call, values, count, STATES)) return false;
    const struct continuous equations = equations_of(it);
    memcpy(values, equations.states, sizeof equations.states);
    return true;
}

bool instance_set_states(struct instance *it, const char *call, const double values[],
                         size_t count)
{
    if (!array(it, call, values, count, STATES) || !require(it, CONTINUOUS, call)) return false;
    if (!all_finite(it, call, values, count)) return false;
    memcpy(it->now.of.solver.states, values, sizeof it->now.of.solver.states);
    return true;
}

bool instance_get_rates(struct instance *it, const char *call, double values[], size_t count)
{
    if (!array(it, call, values, count, STATES)) return false;
    struct block scratch;
    const struct continuous equations = equations_of(it);
    continuous_rates(&equations, acting(it, &scratch), values);
    return all_finite(it, call, values, count);
}

bool instance_get_nominals(struct instance *it, const char *call, double values[], size_t count)
{
    if (!array(it, call, values, count, STATES)) return false;
    continuous_nominals(&it->now.block, values);
    return true;
}

bool instance_get_indicators(struct instance *it, const char *call, double values[],
                             size_t count)
{
    if (!array(it, call, values, count, INDICATORS)) return false;
    struct block scratch;
    const struct continuous equations = equations_of(it);
    continuous_indicators(&equations, acting(it, &scratch), values);
    return all_finite(it, call, values, count);
}

/* States. */

static bool is_live(const struct instance *it, const void *handle)
{
    const struct state *state = handle;
    return state != NULL && state->mark == it->mark;
}

static bool is_freed(const struct instance *it, const void *handle)
{
    const struct state *state = handle;
    return state != NULL && state->mark == ~it->mark;
}

/* Take the longest freed state off the list. */
static struct state *oldest_freed(struct instance *it)
{
    struct state *state = it->oldest_freed;
    it->oldest_freed = state->next;
    if (state->next == NULL) it->newest_freed = NULL;
    it->freed--;
    return state;
}

/* Put a situation where a handle points, or into a new state if it points to none. */
static bool keep(struct instance *it, const char *call, const struct situation *situation,
                 void **handle)
{
    char reason[MESSAGE_SIZE];
    struct state *state = *handle;
    if (!is_live(it, state))
        state = it->freed < LEAST_FREED ? malloc(sizeof *state) : oldest_freed(it);
    if (state == NULL) {
        snprintf(reason, sizeof reason, "%s: out of memory", call);
        return instance_fail(it, reason);
    }
    state->mark = it->mark;
    state->next = NULL;
    state->kept = *situation;
    *handle = state;
    return true;
}

/* Whether a handle is a state that lives; `done` with it is what the call was to do. */
static bool held(struct instance *it, const char *done, const void *handle)
{
    char reason[MESSAGE_SIZE];
    if (is_live(it, handle)) return true;
    snprintf(reason, sizeof reason, "the state to %s is none that this FMU handed out", done);
    return instance_fail(it, reason);
}

bool instance_get_state(struct instance *it, const char *call, void **handle)
{
    return sound(it) && instance_given(it, call, "the pointer to the state", handle) &&
           keep(it, call, &it->now, handle);
}

bool instance_set_state(struct instance *it, const void *handle)
{
    if (it == NULL || !held(it, "set", handle)) return false;
    const struct situation *kept = &((const struct state *)handle)->kept;
    const bool runs = STEPPING <= kept->phase && kept->phase <= CONTINUOUS;
    if (runs && (kept->holds != it->has_events || kept->solved != it->solves))
        return instance_fail(it, "the state to set is of an instance that was made with event mode "
                                 "or for model exchange where this one was not, or the other way "
                                 "round");
    it->now = *kept;
    it->ready = it->failed = false;
    memset(it->gathered, 0, sizeof it->gathered);
    return true;
}

bool instance_free_state(struct instance *it, const char *call, void **handle)
{
    if (it == NULL || !instance_given(it, call, "the pointer to the state", handle)) return false;
    if (*handle != NULL && !is_freed(it, *handle)) {
        if (!held(it, "free", *handle)) return false;
        struct state *state = *handle;
        state->mark = ~it->mark;
        state->next = NULL;
        if (it->newest_freed == NULL)
            it->oldest_freed = state;
        else
            it->newest_freed->next = state;
        it->newest_freed = state;
        it->freed++;
    }
    *handle = NULL;
    return true;
}

bool instance_state_size(struct instance *it, const char *call, const void *handle, size_t *size)
{
    if (it == NULL || !held(it, "serialize", handle) || !instance_given(it, call, "size", size))
        return false;
    *size = bytes_count();
    return true;
}

bool instance_write_state(struct instance *it, const char *call, const void *handle,
                          unsigned char *bytes, size_t size)
{
    char reason[MESSAGE_SIZE];
    if (it == NULL || !held(it, "serialize", handle) ||
        !instance_given(it, call, "the list of bytes", bytes))
        return false;
    if (size < bytes_count()) {
        snprintf(reason, sizeof reason, "a state has %lu bytes, and there is room for %lu",
                 (unsigned long)bytes_count(), (unsigned long)size);
        return instance_fail(it, reason);
    }
    bytes_write(&((const struct state *)handle)->kept, bytes);
    return true;
}

bool instance_read_state(struct instance *it, const char *call, const unsigned char *bytes,
                         size_t size, void **handle)
{
    char reason[MESSAGE_SIZE];
    struct situation situation;
    if (it == NULL || !instance_given(it, call, "the pointer to the state", handle) ||
        !instance_given(it, call, "the list of bytes", bytes))
        return false;
    if (!bytes_read(bytes, size, &situation, reason)) return instance_fail(it, reason);
    return keep(it, call, &situation, handle);
}
