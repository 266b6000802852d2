/* What both FMI versions share: phases, values, outputs, states, messages, failures.
 *
 * Every function that returns bool returns false where the call is refused. The reason was told to
 * the simulator's log then, and from there on every call of the instance is refused with it until
 * instance_reset or instance_set_state; calls that do not depend on the motion are excepted, as
 * each one says. An instance that is NULL is refused without a message. `call` is the name of the
 * FMI function.
 *
 * Nothing is kept outside of instances and states, so instances may run in threads of their own. */
#ifndef STICKSLIP_INSTANCE_H
#define STICKSLIP_INSTANCE_H

#include "situation.h"
#include "text.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct instance;
struct state;

/* As both FMI versions number them. */
enum status { STATUS_OK, STATUS_WARNING, STATUS_DISCARD, STATUS_ERROR };

/* Types of variables; an enumeration is an Integer in FMI 2.0. */
enum sort { SORT_REAL, SORT_INTEGER, SORT_BOOLEAN, SORT_ENUMERATION, SORTS };

/* A type whose variables calls get and set. */
struct type {
    const char *name;
    unsigned sorts; /* a bit 1 << sort for each sort of variables that it has */
    bool has_time;  /* whether the independent variable is of this type */
};

/* What an FMI version has of its own. */
struct version {
    const char *names[SORTS];  /* of the types of variables */
    const char *identity_name; /* of the argument that identifies the FMU */
    void (*log)(const struct instance *it, enum status status, const char *category,
                const char *text);
};

/* Freed states are taken again, the oldest first, and so many wait: a use of one of those is seen,
 * and no memory is read that was given back. */
enum { LEAST_FREED = 16 };

struct instance {
    struct situation now;
    bool ready;                       /* whether a step may go straight to the block */
    bool failed;                      /* a call failed, for the reason in `fault` */
    int warned;                       /* count of the remarks of the law that were told last */
    bool has_events;                  /* whether event mode is used */
    bool stops;                       /* whether a step may end early */
    bool solves;                      /* whether it is one for model exchange */
    bool gathers;                     /* whether inputs are set to what they are after the step */
    bool gathered[MOVING];            /* which of them were */
    double ends[MOVING];
    bool discards;                    /* whether its last call for a solver was discarded */
    bool logs_warnings, logs_errors;  /* which messages the simulator wants */
    struct remark warned_of[MOST_REMARKS];
    const struct version *version;
    void (*logger)(void); /* of the simulator, in the type of the FMI version; may be NULL */
    void (*update)(void); /* what gives inputs that move, in the type of FMI 3.0; may be NULL */
    void *environment;
    const char *name;
    uint64_t mark; /* of states of this FMU */
    struct state *oldest_freed, *newest_freed;
    int freed;
    char fault[MESSAGE_SIZE];
};

/* Make an instance; NULL where a name or identity is wrong or memory lacks, which is told. */
struct instance *instance_make(const struct version *version, const char *call, const char *name,
                               const char *identity, const char *identity_given,
                               void (*logger)(void), void *environment);

void instance_free(struct instance *it);

/* Make the instance as it was made, but for what is logged. */
bool instance_reset(struct instance *it);

/* Tell a message to the simulator's log, if it wants such messages. */
void instance_tell(const struct instance *it, enum status status, const char *text);

/* Refuse a call for this reason, or for that of the first failure. */
bool instance_fail(struct instance *it, const char *reason);

/* Refuse a call of a mode that the FMU does not have. */
bool instance_absent(struct instance *it, const char *call);

/* Refuse a call that the FMU does not offer. It changes nothing. */
bool instance_unsupported(const struct instance *it, const char *call);

/* Refuse a NULL argument, by its name. */
bool instance_given(struct instance *it, const char *call, const char *name, const void *argument);

/* Choose the messages that are logged: the categories, or all if there are none. It does not depend
 * on the motion. */
bool instance_log(struct instance *it, const char *call, bool on, size_t count,
                  const char *const categories[]);

bool instance_set_start(struct instance *it, double start_time);
bool instance_enter_initialization(struct instance *it);
bool instance_exit_initialization(struct instance *it);
bool instance_terminate(struct instance *it);

/* The rates of inputs in the next step, at the end of which they stay as they are then. */
bool instance_set_rates(struct instance *it, const char *call, const uint32_t references[],
                        size_t count, const int orders[], const double values[]);

/* Whether this is an input that may move; its position among them. */
bool instance_moves(uint32_t reference, int *position);

/* Move on by one step [s] from this time [s]. A step that would take minutes is discarded: the
 * instance is as it was, and may be called on. */
enum status instance_step(struct instance *it, double time, double step);

/* The same as the instance was told to: with `stops` no further than to the first change of mode,
 * which with `has_events` is left to event mode. */
enum status instance_step_to_event(struct instance *it, double time, double step, bool *event,
                                   bool *early);

/* Event mode, of instances that have it. The update goes through all that is due, and tells when
 * the next change of mode will be [s], infinity where none is known. */
bool instance_enter_event_mode(struct instance *it, const char *call);
bool instance_update(struct instance *it, const char *call, double *next_event);
bool instance_enter_step_mode(struct instance *it);

/* Model exchange. The arrays are of STATES and INDICATORS values. */
bool instance_enter_continuous(struct instance *it, const char *call);
bool instance_set_time(struct instance *it, const char *call, double time);
bool instance_complete_step(struct instance *it, const char *call);
bool instance_get_states(struct instance *it, const char *call, double values[], size_t count);
bool instance_set_states(struct instance *it, const char *call, const double values[],
                         size_t count);
bool instance_get_rates(struct instance *it, const char *call, double values[], size_t count);
bool instance_get_nominals(struct instance *it, const char *call, double values[], size_t count);
bool instance_get_indicators(struct instance *it, const char *call, double values[],
                             size_t count);

/* Get values: instance_begin_get, then instance_get of each. `count` references came with `values`,
 * an array of `value_count`. */
bool instance_begin_get(struct instance *it, const char *call, const struct type *type,
                        const uint32_t references[], size_t count, const void *values,
                        size_t value_count);
bool instance_get(struct instance *it, const struct type *type, const uint32_t references[],
                  size_t count, size_t position, double *value);

/* Set values: instance_begin_set, then instance_set of each, then instance_end_set. */
bool instance_begin_set(struct instance *it, const char *call, const struct type *type,
                        const uint32_t references[], size_t count, const void *values,
                        size_t value_count);
bool instance_set(struct instance *it, const struct type *type, uint32_t reference, double value);
bool instance_end_set(struct instance *it);

/* States. A handle is NULL or a state: where a state is asked for, one that is there already is
 * overwritten. States of another instance of the same FMU are taken. The last four do not depend on
 * the motion. */
bool instance_get_state(struct instance *it, const char *call, void **handle);
bool instance_set_state(struct instance *it, const void *handle);
bool instance_free_state(struct instance *it, const char *call, void **handle);
bool instance_state_size(struct instance *it, const char *call, const void *handle, size_t *size);
bool instance_write_state(struct instance *it, const char *call, const void *handle,
                          unsigned char *bytes, size_t size);
bool instance_read_state(struct instance *it, const char *call, const unsigned char *bytes,
                         size_t size, void **handle);

#endif
