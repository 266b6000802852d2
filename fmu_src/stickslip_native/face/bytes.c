/* States as bytes: see the header. */
#include "bytes.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

static const unsigned char MAGIC[8] = {'s', 'l', 'i', 'p', 's', 't', 'a', 't'};

enum { VERSION = 3, HASH_SIZE = 8, HEAD_SIZE = sizeof MAGIC + 4 + 4 + HASH_SIZE };

/* What is written of a situation. */
struct saved {
    struct block_state block;
    double time, rates[MOVING];
    int32_t phase;
    bool moves, settled, holds, solved;
    double held[DISCRETE];
    struct continuous solver;
};

/* How many numbers a solver has, and what is written of it or of outputs that are held. */
enum { SOLVER = STATES + 7, MOST_BESIDE = SOLVER > DISCRETE ? SOLVER : DISCRETE };

/* Bytes that are counted, written, read or compared, one field after the other. */
struct stream {
    enum { COUNT, WRITE, READ, COMPARE } way;
    unsigned char *to;
    const unsigned char *from;
    size_t at;
    bool sound; /* what was read is finite, what was compared is equal */
};

static const uint64_t HASH_START = 14695981039346656037u;

static uint64_t hash_with(uint64_t hash, const void *bytes, size_t count)
{
    const unsigned char *next = bytes;
    for (size_t n = 0; n < count; n++) hash = (hash ^ next[n]) * 1099511628211u;
    return hash;
}

uint64_t hash_of(const void *bytes, size_t count)
{
    return hash_with(HASH_START, bytes, count);
}

static uint64_t hash_of_names(void)
{
    uint64_t hash = HASH_START;
    for (int n = 0; n < VARIABLES; n++)
        if (ROWS[n].settable) hash = hash_with(hash, ROWS[n].name, strlen(ROWS[n].name) + 1);
    return hash;
}

/* A number of `size` bytes, 8 at most; what is read replaces it. Inline, so that the loops have a
 * fixed length. */
static inline uint64_t number(struct stream *stream, uint64_t value, size_t size)
{
    const size_t at = stream->at;
    uint64_t there = 0;
    stream->at += size;
    if (stream->way == COUNT) return value;
    if (stream->way == WRITE) {
        for (size_t n = 0; n < size; n++)
            stream->to[at + n] = (unsigned char)(value >> (8 * n) & 0xff);
        return value;
    }
    for (size_t n = 0; n < size; n++) there |= (uint64_t)stream->from[at + n] << (8 * n);
    if (stream->way == READ) return there;
    if (there != value) stream->sound = false;
    return value;
}

static void real(struct stream *stream, double *value)
{
    uint64_t bits;
    memcpy(&bits, value, sizeof bits);
    bits = number(stream, bits, sizeof bits);
    memcpy(value, &bits, sizeof bits);
    if (!isfinite(*value)) stream->sound = false;
}

static void integer(struct stream *stream, int32_t *value)
{
    /* Two's complement, whatever the conversion of large numbers gives. */
    const uint32_t bits = (uint32_t)number(stream, (uint32_t)*value, 4);
    *value = bits <= INT32_MAX ? (int32_t)bits : -(int32_t)(UINT32_MAX - bits) - 1;
}

static void truth(struct stream *stream, bool *value)
{
    /* A byte other than 0 and 1 is found where what was read is compared. */
    *value = number(stream, *value ? 1 : 0, 1) != 0;
}

static void settings(struct stream *stream, struct settings *values)
{
    for (int n = 0; n < VARIABLES; n++)
        if (ROWS[n].settable) real(stream, (double *)((char *)values + ROWS[n].offset));
}

static void sum(struct stream *stream, struct sum *value)
{
    real(stream, &value->high);
    real(stream, &value->low);
}

static void visit(struct stream *stream, struct saved *it)
{
    struct start *start = &it->block.start;
    struct meter *meter = &it->block.meter;
    int32_t mode = start->mode;

    settings(stream, &it->block.wanted);
    settings(stream, &it->block.settings);
    integer(stream, &mode);
    start->mode = (int)mode;
    truth(stream, &start->known);
    real(stream, &start->z);
    real(stream, &start->x_dot);
    real(stream, &start->force);
    real(stream, &start->age);
    if (LAW.whole) {
        real(stream, &start->own.state);
        real(stream, &start->own.stride);
        real(stream, &start->own.rows);
    }
    sum(stream, &it->block.elapsed);
    sum(stream, &it->block.x_start);
    sum(stream, &it->block.W_pull);
    sum(stream, &it->block.W_k);
    sum(stream, &it->block.Q_friction);
    real(stream, &meter->t_stick);
    real(stream, &meter->t_slip);
    real(stream, &meter->T);
    real(stream, &meter->delta_x);
    real(stream, &meter->spring_drop);
    real(stream, &meter->x_dot_peak);
    real(stream, &meter->t_event);
    integer(stream, &meter->n_slips);
    truth(stream, &meter->seen_break_away);
    real(stream, &meter->peak);
    sum(stream, &meter->phase);
    sum(stream, &meter->cycle);
    sum(stream, &meter->displacement);
    sum(stream, &meter->relief);
    truth(stream, &it->block.started);
    truth(stream, &it->block.changed);
    real(stream, &it->time);
    for (int n = 0; n < MOVING; n++) real(stream, &it->rates[n]);
    truth(stream, &it->moves);
    integer(stream, &it->phase);
    truth(stream, &it->settled);
    truth(stream, &it->holds);
    truth(stream, &it->solved);
    truth(stream, &it->solver.moved);
    double *of_solver[SOLVER] = {&it->solver.time, &it->solver.entered, &it->solver.due,
                                 &it->solver.peak, &it->solver.v,       &it->solver.load,
                                 &it->solver.F_ext};
    for (int n = 0; n < STATES; n++) of_solver[SOLVER - STATES + n] = &it->solver.states[n];
    const int count = it->solved ? SOLVER : it->holds ? DISCRETE : 0;
    for (int n = 0; n < MOST_BESIDE; n++) {
        double none = 0.0;
        real(stream, n >= count ? &none : it->solved ? of_solver[n] : &it->held[n]);
    }
}

/* All that comes before the fields. */
static void head(struct stream *stream, uint64_t *version, uint64_t *length, uint64_t *names)
{
    *version = number(stream, *version, 4);
    *length = number(stream, *length, 4);
    *names = number(stream, *names, HASH_SIZE);
}

size_t bytes_count(void)
{
    struct saved none = {.time = 0.0};
    struct stream stream = {.way = COUNT, .at = HEAD_SIZE, .sound = true};
    visit(&stream, &none);
    return stream.at + HASH_SIZE;
}

void bytes_write(const struct situation *situation, unsigned char *bytes)
{
    struct saved saved = {
        .time = situation->time,
        .phase = (int32_t)situation->phase,
        .moves = situation->moves,
        .settled = situation->settled,
        .holds = situation->holds,
        .solved = situation->solved,
    };
    if (saved.solved) saved.solver = situation->of.solver;
    memcpy(saved.rates, situation->rates, sizeof saved.rates);
    if (saved.holds) memcpy(saved.held, situation->of.held, sizeof saved.held);
    struct stream stream = {.way = WRITE, .to = bytes, .at = sizeof MAGIC, .sound = true};
    uint64_t version = VERSION, length = bytes_count(), names = hash_of_names();
    block_save(&situation->block, &saved.block);
    memcpy(bytes, MAGIC, sizeof MAGIC);
    head(&stream, &version, &length, &names);
    visit(&stream, &saved);
    number(&stream, hash_of(bytes, stream.at), HASH_SIZE);
}

/* Whether all values are within the bounds of their rows; the reason if not. */
static bool within_bounds(const struct settings *values, char reason[MESSAGE_SIZE])
{
    for (int n = 0; n < VARIABLES; n++) {
        if (!ROWS[n].settable) continue;
        const double value = *(const double *)((const char *)values + ROWS[n].offset);
        if (in_range(&ROWS[n], value)) continue;
        range_text(&ROWS[n], value, reason);
        return false;
    }
    return true;
}

/* Whether outputs that are held have values that they can have. */
static bool can_hold(const struct saved *it)
{
    if (!it->holds) return true;
    for (int n = 0; n < VARIABLES; n++) {
        if (ROWS[n].discrete < 0) continue;
        const double value = it->held[ROWS[n].discrete];
        if (!in_range(&ROWS[n], value)) return false;
        if (ROWS[n].kind == BOOLEAN && value != 0.0 && value != 1.0) return false;
        if (ROWS[n].kind == INTEGER && !(fabs(value) <= INT32_MAX && value == trunc(value)))
            return false;
    }
    return true;
}

/* Whether settings that are not as last set may be so: fixed ones never, others till they act. */
static bool can_wait(const struct block_state *it)
{
    for (int n = 0; n < VARIABLES; n++) {
        const size_t offset = ROWS[n].offset;
        if (ROWS[n].settable && (ROWS[n].fixed || !it->changed) &&
            *(const double *)((const char *)&it->wanted + offset) !=
                *(const double *)((const char *)&it->settings + offset))
            return false;
    }
    return true;
}

/* Whether an instance can be in this phase with such a block and values, and shows finite ones. */
static bool consistent(const struct saved *it)
{
    if (!isfinite(meter_frequency(&it->block.meter)) || !can_hold(it)) return false;
    switch (it->phase) {
    case INSTANTIATED:
    case INITIALIZATION:
        return !it->block.started && !it->block.changed && !it->holds && !it->solved &&
               (!it->settled || can_wait(&it->block));
    case STEPPING:
    case EVENT_DUE:
    case EVENT_MODE:
    case CONTINUOUS:
        if (it->solved ? it->holds || it->phase < EVENT_MODE
                       : it->phase == CONTINUOUS || (it->phase != STEPPING && !it->holds))
            return false;
        return it->settled && can_wait(&it->block);
    case TERMINATED: return true;
    default: return false;
    }
}

bool bytes_read(const unsigned char *bytes, size_t size, struct situation *made,
                char reason[MESSAGE_SIZE])
{
    struct saved saved = {.time = 0.0};
    struct stream stream = {.way = READ, .from = bytes, .at = sizeof MAGIC, .sound = true};
    const size_t expected = bytes_count();
    uint64_t version = 0, length = 0, names = 0;

    if (size < sizeof MAGIC + 4 || memcmp(bytes, MAGIC, sizeof MAGIC) != 0) {
        snprintf(reason, MESSAGE_SIZE, "the bytes hold no state");
        return false;
    }
    if (number(&stream, 0, 4) != VERSION) {
        snprintf(reason, MESSAGE_SIZE, "the bytes hold a state in another format than version %d",
                 VERSION);
        return false;
    }
    if (size != expected) {
        snprintf(reason, MESSAGE_SIZE, "a state has %lu bytes, and these are %lu",
                 (unsigned long)expected, (unsigned long)size);
        return false;
    }
    stream.at = expected - HASH_SIZE;
    if (number(&stream, 0, HASH_SIZE) != hash_of(bytes, expected - HASH_SIZE)) {
        snprintf(reason, MESSAGE_SIZE, "the bytes of the state were changed: the checksum differs");
        return false;
    }
    stream.at = sizeof MAGIC;
    head(&stream, &version, &length, &names);
    if (length != expected || names != hash_of_names()) {
        snprintf(reason, MESSAGE_SIZE, "the bytes hold a state of another friction law");
        return false;
    }
    visit(&stream, &saved);
    if (!stream.sound) {
        snprintf(reason, MESSAGE_SIZE, "the saved state has not the structure of a state");
        return false;
    }
    if (!within_bounds(&saved.block.wanted, reason) ||
        !within_bounds(&saved.block.settings, reason))
        return false;
    enum refusal refused =
        consistent(&saved) ? block_restore(&made->block, &saved.block) : NO_SUCH_STATE;
    if (refused == ACCEPTED) {
        /* A block has no more than one way to be written: what it does not take up is 0. */
        stream = (struct stream){.way = COMPARE, .from = bytes, .at = HEAD_SIZE, .sound = true};
        block_save(&made->block, &saved.block);
        if (!saved.solved) saved.solver.moved = false;
        visit(&stream, &saved);
        if (!stream.sound) refused = NO_SUCH_STATE;
    }
    if (refused != ACCEPTED) {
        refusal_text(refused, &saved.block.settings, 0.0, 0.0, reason);
        return false;
    }
    made->time = saved.time;
    made->phase = (enum phase)saved.phase;
    memcpy(made->rates, saved.rates, sizeof made->rates);
    made->moves = saved.moves;
    made->settled = saved.settled;
    made->holds = saved.holds;
    made->solved = saved.solved;
    if (saved.solved) made->of.solver = saved.solver;
    if (saved.holds) memcpy(made->of.held, saved.held, sizeof saved.held);
    return true;
}
