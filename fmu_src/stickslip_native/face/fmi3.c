/* The functions of FMI 3.0, of which co-simulation without clocks has a part.
 *
 * A call that is refused returns fmi3Error, and the instance refuses all that depends on its motion
 * until fmi3Reset or fmi3SetFMUState: instance.h. `loggingOn` is about debug messages, and there are
 * none: warnings and errors reach the log until fmi3SetDebugLogging says otherwise. */
#include "export.h"
#include "fmi3_types.h"
#include "identity.h"
#include "instance.h"

#include <float.h>
#include <stddef.h>
#include <string.h>

static const struct type Float32 = {"Float32", 0, false};
static const struct type Float64 = {"Float64", 1u << SORT_REAL, true};
static const struct type Int8 = {"Int8", 0, false};
static const struct type UInt8 = {"UInt8", 0, false};
static const struct type Int16 = {"Int16", 0, false};
static const struct type UInt16 = {"UInt16", 0, false};
static const struct type Int32 = {"Int32", 1u << SORT_INTEGER, false};
static const struct type UInt32 = {"UInt32", 0, false};
static const struct type Int64 = {"Int64", 1u << SORT_ENUMERATION, false};
static const struct type UInt64 = {"UInt64", 0, false};
static const struct type Boolean = {"Boolean", 1u << SORT_BOOLEAN, false};
static const struct type String = {"String", 0, false};
static const struct type Binary = {"Binary", 0, false};

static fmi3Status status_of(bool taken)
{
    return taken ? fmi3OK : fmi3Error;
}

static void log_message(const struct instance *it, enum status status, const char *category,
                        const char *text)
{
    ((fmi3LogMessageCallback)it->logger)(it->environment, (fmi3Status)status, category, text);
}

static const struct version FMI3_VERSION = {
    {"Float64", "Int32", "Boolean", "Int64"}, "instantiation token", log_message};

/* Version and log. */

STICKSLIP_EXPORT const char *FMI3(fmi3GetVersion)(void)
{
    return "3.0";
}

STICKSLIP_EXPORT fmi3Status FMI3(fmi3SetDebugLogging)(fmi3Instance instance, fmi3Boolean on,
                                                      size_t count, const fmi3String categories[])
{
    return status_of(instance_log(instance, "fmi3SetDebugLogging", on, count, categories));
}

/* Instances. */

STICKSLIP_EXPORT fmi3Instance FMI3(fmi3InstantiateCoSimulation)(
    fmi3String name, fmi3String token, fmi3String resources IGNORED, fmi3Boolean visible IGNORED,
    fmi3Boolean logging_on IGNORED, fmi3Boolean event_mode_used, fmi3Boolean early_return_allowed,
    const fmi3ValueReference intermediate[], size_t intermediate_count,
    fmi3InstanceEnvironment environment, fmi3LogMessageCallback logger,
    fmi3IntermediateUpdateCallback update)
{
    bool can = intermediate_count == 0 || (intermediate != NULL && update != NULL);
    int position;
    for (size_t n = 0; can && n < intermediate_count; n++)
        can = instance_moves(intermediate[n], &position);
    if (!can) {
        if (logger != NULL)
            logger(environment, fmi3Error, "logStatusError",
                   "fmi3InstantiateCoSimulation: intermediate update is for v, load and F_ext");
        return NULL;
    }
    struct instance *it =
        instance_make(&FMI3_VERSION, "fmi3InstantiateCoSimulation", name, STICKSLIP_IDENTITY, token,
                      (void (*)(void))logger, environment);
    if (it != NULL) {
        it->update = intermediate_count > 0 ? (void (*)(void))update : NULL;
        it->has_events = event_mode_used;
        it->stops = early_return_allowed;
    }
    return it;
}

STICKSLIP_EXPORT fmi3Instance FMI3(fmi3InstantiateModelExchange)(
    fmi3String name, fmi3String token, fmi3String resources IGNORED, fmi3Boolean visible IGNORED,
    fmi3Boolean logging_on IGNORED, fmi3InstanceEnvironment environment,
    fmi3LogMessageCallback logger)
{
    struct instance *it =
        instance_make(&FMI3_VERSION, "fmi3InstantiateModelExchange", name, STICKSLIP_IDENTITY,
                      token, (void (*)(void))logger, environment);
    if (it != NULL && LAW.whole) {
        instance_fail(it, "fmi3InstantiateModelExchange: this friction law is for co-simulation");
        instance_free(it);
        return NULL;
    }
    if (it != NULL) it->solves = true;
    return it;
}

STICKSLIP_EXPORT fmi3Instance FMI3(fmi3InstantiateScheduledExecution)(
    fmi3String name IGNORED, fmi3String token IGNORED, fmi3String resources IGNORED,
    fmi3Boolean visible IGNORED, fmi3Boolean logging_on IGNORED,
    fmi3InstanceEnvironment environment, fmi3LogMessageCallback logger,
    fmi3ClockUpdateCallback clock_update IGNORED, fmi3LockPreemptionCallback lock IGNORED,
    fmi3UnlockPreemptionCallback unlock IGNORED)
{
    if (logger != NULL)
        logger(environment, fmi3Error, "logStatusError",
               "fmi3InstantiateScheduledExecution: scheduled execution is not offered");
    return NULL;
}

STICKSLIP_EXPORT void FMI3(fmi3FreeInstance)(fmi3Instance instance)
{
    instance_free(instance);
}

/* Phases. */

STICKSLIP_EXPORT fmi3Status FMI3(fmi3EnterInitializationMode)(
    fmi3Instance instance, fmi3Boolean tolerance_defined IGNORED, fmi3Float64 tolerance IGNORED,
    fmi3Float64 start_time, fmi3Boolean stop_time_defined IGNORED, fmi3Float64 stop_time IGNORED)
{
    const struct instance *it = instance;
    if (it != NULL && it->now.phase == INSTANTIATED && !instance_set_start(instance, start_time))
        return fmi3Error;
    return status_of(instance_enter_initialization(instance));
}

#define PHASE(NAME, FUNCTION)                                                                      \
    STICKSLIP_EXPORT fmi3Status FMI3(NAME)(fmi3Instance instance)                                  \
    {                                                                                              \
        return status_of(FUNCTION(instance));                                                      \
    }

PHASE(fmi3ExitInitializationMode, instance_exit_initialization)
PHASE(fmi3Terminate, instance_terminate)
PHASE(fmi3Reset, instance_reset)
PHASE(fmi3EnterStepMode, instance_enter_step_mode)

STICKSLIP_EXPORT fmi3Status FMI3(fmi3DoStep)(fmi3Instance instance, fmi3Float64 time,
                                             fmi3Float64 step,
                                             fmi3Boolean no_earlier_state IGNORED,
                                             fmi3Boolean *event_handling_needed,
                                             fmi3Boolean *terminate_simulation,
                                             fmi3Boolean *early_return,
                                             fmi3Float64 *last_successful_time)
{
    struct instance *it = instance;
    if (it == NULL ||
        !instance_given(it, "fmi3DoStep", "eventHandlingNeeded", event_handling_needed) ||
        !instance_given(it, "fmi3DoStep", "terminateSimulation", terminate_simulation) ||
        !instance_given(it, "fmi3DoStep", "earlyReturn", early_return) ||
        !instance_given(it, "fmi3DoStep", "lastSuccessfulTime", last_successful_time))
        return fmi3Error;
    *event_handling_needed = *terminate_simulation = *early_return = false;
    if (it->gathers)
        return status_of(instance_fail(it, "fmi3DoStep is not allowed in an intermediate update"));
    if (it->update != NULL && !it->failed) {
        /* The importer sets inputs to what they are at the end of the step. */
        fmi3Boolean requested = false;
        fmi3Float64 until = time + step;
        memset(it->gathered, 0, sizeof it->gathered);
        it->gathers = true;
        ((fmi3IntermediateUpdateCallback)it->update)(it->environment, until, true, false, false,
                                                     false, &requested, &until);
        it->gathers = false;
    }
    const enum status status =
        it->has_events || it->stops
            ? instance_step_to_event(it, time, step, event_handling_needed, early_return)
            : instance_step(it, time, step);
    *last_successful_time = it->now.time;
    return (fmi3Status)status;
}

/* Event mode. */

STICKSLIP_EXPORT fmi3Status FMI3(fmi3EnterEventMode)(fmi3Instance instance)
{
    return status_of(instance_enter_event_mode(instance, "fmi3EnterEventMode"));
}

STICKSLIP_EXPORT fmi3Status FMI3(fmi3UpdateDiscreteStates)(
    fmi3Instance instance, fmi3Boolean *need_update, fmi3Boolean *terminate,
    fmi3Boolean *nominals_changed, fmi3Boolean *values_changed, fmi3Boolean *next_event_defined,
    fmi3Float64 *next_event)
{
    static const char *const CALL = "fmi3UpdateDiscreteStates";
    struct instance *it = instance;
    if (it == NULL || !instance_given(it, CALL, "discreteStatesNeedUpdate", need_update) ||
        !instance_given(it, CALL, "terminateSimulation", terminate) ||
        !instance_given(it, CALL, "nominalsOfContinuousStatesChanged", nominals_changed) ||
        !instance_given(it, CALL, "valuesOfContinuousStatesChanged", values_changed) ||
        !instance_given(it, CALL, "nextEventTimeDefined", next_event_defined) ||
        !instance_given(it, CALL, "nextEventTime", next_event))
        return fmi3Error;
    *need_update = *terminate = *nominals_changed = *values_changed = *next_event_defined = false;
    if (!instance_update(it, CALL, next_event)) return fmi3Error;
    *next_event_defined = *next_event < DBL_MAX;
    /* A solver that is not told so goes on with what it knew of the arc before. */
    *values_changed = *nominals_changed = it->solves;
    return fmi3OK;
}

/* Model exchange. */

STICKSLIP_EXPORT fmi3Status FMI3(fmi3EnterContinuousTimeMode)(fmi3Instance instance)
{
    return status_of(instance_enter_continuous(instance, "fmi3EnterContinuousTimeMode"));
}

STICKSLIP_EXPORT fmi3Status FMI3(fmi3SetTime)(fmi3Instance instance, fmi3Float64 time)
{
    return status_of(instance_set_time(instance, "fmi3SetTime", time));
}

STICKSLIP_EXPORT fmi3Status FMI3(fmi3CompletedIntegratorStep)(
    fmi3Instance instance, fmi3Boolean no_earlier_state IGNORED, fmi3Boolean *enter_event_mode,
    fmi3Boolean *terminate)
{
    static const char *const CALL = "fmi3CompletedIntegratorStep";
    if (!instance_complete_step(instance, CALL) ||
        !instance_given(instance, CALL, "enterEventMode", enter_event_mode) ||
        !instance_given(instance, CALL, "terminateSimulation", terminate))
        return fmi3Error;
    *enter_event_mode = *terminate = false;
    return fmi3OK;
}

#define ARRAY(NAME, FUNCTION, CONST)                                                               \
    STICKSLIP_EXPORT fmi3Status FMI3(NAME)(fmi3Instance instance, CONST fmi3Float64 values[],      \
                                           size_t count)                                           \
    {                                                                                              \
        const struct instance *it = instance;                                                      \
        if (FUNCTION(instance, #NAME, values, count)) return fmi3OK;                               \
        return it != NULL && it->discards ? fmi3Discard : fmi3Error;                               \
    }

#define COUNT(NAME, SIZE)                                                                          \
    STICKSLIP_EXPORT fmi3Status FMI3(NAME)(fmi3Instance instance, size_t *count)                   \
    {                                                                                              \
        if (instance == NULL || !instance_given(instance, #NAME, "the count", count))              \
            return fmi3Error;                                                                      \
        *count = SIZE;                                                                             \
        return fmi3OK;                                                                             \
    }

ARRAY(fmi3SetContinuousStates, instance_set_states, const)
ARRAY(fmi3GetContinuousStates, instance_get_states, )
ARRAY(fmi3GetContinuousStateDerivatives, instance_get_rates, )
ARRAY(fmi3GetNominalsOfContinuousStates, instance_get_nominals, )
ARRAY(fmi3GetEventIndicators, instance_get_indicators, )
COUNT(fmi3GetNumberOfContinuousStates, STATES)
COUNT(fmi3GetNumberOfEventIndicators, INDICATORS)

/* Values of numbers. */

#define GET(NAME)                                                                                  \
    STICKSLIP_EXPORT fmi3Status FMI3(fmi3Get##NAME)(                                               \
        fmi3Instance instance, const fmi3ValueReference references[], size_t count,                \
        fmi3##NAME values[], size_t value_count)                                                   \
    {                                                                                              \
        double value;                                                                              \
        if (!instance_begin_get(instance, "fmi3Get" #NAME, &NAME, references, count, values,       \
                                value_count))                                                      \
            return fmi3Error;                                                                      \
        for (size_t n = 0; n < count; n++) {                                                       \
            if (!instance_get(instance, &NAME, references, count, n, &value)) return fmi3Error;    \
            values[n] = (fmi3##NAME)value;                                                         \
        }                                                                                          \
        return fmi3OK;                                                                             \
    }

#define SET(NAME)                                                                                  \
    STICKSLIP_EXPORT fmi3Status FMI3(fmi3Set##NAME)(                                               \
        fmi3Instance instance, const fmi3ValueReference references[], size_t count,                \
        const fmi3##NAME values[], size_t value_count)                                             \
    {                                                                                              \
        if (!instance_begin_set(instance, "fmi3Set" #NAME, &NAME, references, count, values,       \
                                value_count))                                                      \
            return fmi3Error;                                                                      \
        for (size_t n = 0; n < count; n++)                                                         \
            if (!instance_set(instance, &NAME, references[n], (double)values[n]))                  \
                return fmi3Error;                                                                  \
        return status_of(instance_end_set(instance));                                              \
    }

GET(Float32)
GET(Float64)
GET(Int8)
GET(UInt8)
GET(Int16)
GET(UInt16)
GET(Int32)
GET(UInt32)
GET(Int64)
GET(UInt64)
GET(Boolean)
SET(Float32)
SET(Float64)
SET(Int8)
SET(UInt8)
SET(Int16)
SET(UInt16)
SET(Int32)
SET(UInt32)
SET(Int64)
SET(UInt64)
SET(Boolean)

/* Values of other types: no variable has one, so none is read or written. */

static fmi3Status get_none(struct instance *it, const char *call, const struct type *type,
                           const fmi3ValueReference references[], size_t count, const void *values,
                           size_t value_count)
{
    double none;
    if (!instance_begin_get(it, call, type, references, count, values, value_count))
        return fmi3Error;
    return status_of(count == 0 || instance_get(it, type, references, count, 0, &none));
}

static fmi3Status set_none(struct instance *it, const char *call, const struct type *type,
                           const fmi3ValueReference references[], size_t count, const void *values,
                           size_t value_count)
{
    if (!instance_begin_set(it, call, type, references, count, values, value_count))
        return fmi3Error;
    return status_of(count == 0 || instance_set(it, type, references[0], 0.0));
}

#define NO_VALUES(NAME, ...)                                                                       \
    STICKSLIP_EXPORT fmi3Status FMI3(fmi3Get##NAME)(                                               \
        fmi3Instance instance, const fmi3ValueReference references[], size_t count, __VA_ARGS__    \
        fmi3##NAME values[], size_t value_count)                                                   \
    {                                                                                              \
        return get_none(instance, "fmi3Get" #NAME, &NAME, references, count, values, value_count); \
    }                                                                                              \
                                                                                                   \
    STICKSLIP_EXPORT fmi3Status FMI3(fmi3Set##NAME)(                                               \
        fmi3Instance instance, const fmi3ValueReference references[], size_t count, __VA_ARGS__    \
        const fmi3##NAME values[], size_t value_count)                                             \
    {                                                                                              \
        return set_none(instance, "fmi3Set" #NAME, &NAME, references, count, values, value_count); \
    }

NO_VALUES(String, )
NO_VALUES(Binary, const size_t sizes[] IGNORED, )

/* States. */

STICKSLIP_EXPORT fmi3Status FMI3(fmi3GetFMUState)(fmi3Instance instance, fmi3FMUState *state)
{
    return status_of(instance_get_state(instance, "fmi3GetFMUState", state));
}

STICKSLIP_EXPORT fmi3Status FMI3(fmi3SetFMUState)(fmi3Instance instance, fmi3FMUState state)
{
    return status_of(instance_set_state(instance, state));
}

STICKSLIP_EXPORT fmi3Status FMI3(fmi3FreeFMUState)(fmi3Instance instance, fmi3FMUState *state)
{
    return status_of(instance_free_state(instance, "fmi3FreeFMUState", state));
}

STICKSLIP_EXPORT fmi3Status FMI3(fmi3SerializedFMUStateSize)(fmi3Instance instance,
                                                             fmi3FMUState state, size_t *size)
{
    return status_of(instance_state_size(instance, "fmi3SerializedFMUStateSize", state, size));
}

STICKSLIP_EXPORT fmi3Status FMI3(fmi3SerializeFMUState)(fmi3Instance instance, fmi3FMUState state,
                                                        fmi3Byte bytes[], size_t size)
{
    return status_of(instance_write_state(instance, "fmi3SerializeFMUState", state, bytes, size));
}

STICKSLIP_EXPORT fmi3Status FMI3(fmi3DeserializeFMUState)(fmi3Instance instance,
                                                          const fmi3Byte bytes[], size_t size,
                                                          fmi3FMUState *state)
{
    return status_of(instance_read_state(instance, "fmi3DeserializeFMUState", bytes, size, state));
}

/* Calls that the FMU does not offer. */

#define UNSUPPORTED(NAME, ...)                                                                     \
    STICKSLIP_EXPORT fmi3Status FMI3(NAME)(fmi3Instance instance, __VA_ARGS__)                     \
    {                                                                                              \
        return status_of(instance_unsupported(instance, #NAME));                                   \
    }

UNSUPPORTED(fmi3GetNumberOfVariableDependencies, fmi3ValueReference reference IGNORED,
            size_t *count IGNORED)
UNSUPPORTED(fmi3GetVariableDependencies, fmi3ValueReference dependent IGNORED,
            size_t dependent_elements[] IGNORED, fmi3ValueReference independents[] IGNORED,
            size_t independent_elements[] IGNORED, fmi3DependencyKind kinds[] IGNORED,
            size_t count IGNORED)
UNSUPPORTED(fmi3GetDirectionalDerivative, const fmi3ValueReference unknowns[] IGNORED,
            size_t unknown_count IGNORED, const fmi3ValueReference knowns[] IGNORED,
            size_t known_count IGNORED, const fmi3Float64 seed[] IGNORED,
            size_t seed_count IGNORED, fmi3Float64 sensitivity[] IGNORED,
            size_t sensitivity_count IGNORED)
UNSUPPORTED(fmi3GetAdjointDerivative, const fmi3ValueReference unknowns[] IGNORED,
            size_t unknown_count IGNORED, const fmi3ValueReference knowns[] IGNORED,
            size_t known_count IGNORED, const fmi3Float64 seed[] IGNORED,
            size_t seed_count IGNORED, fmi3Float64 sensitivity[] IGNORED,
            size_t sensitivity_count IGNORED)
UNSUPPORTED(fmi3GetOutputDerivatives, const fmi3ValueReference references[] IGNORED,
            size_t count IGNORED, const fmi3Int32 orders[] IGNORED, fmi3Float64 values[] IGNORED,
            size_t value_count IGNORED)

STICKSLIP_EXPORT fmi3Status FMI3(fmi3EnterConfigurationMode)(fmi3Instance instance)
{
    return status_of(instance_unsupported(instance, "fmi3EnterConfigurationMode"));
}

STICKSLIP_EXPORT fmi3Status FMI3(fmi3ExitConfigurationMode)(fmi3Instance instance)
{
    return status_of(instance_unsupported(instance, "fmi3ExitConfigurationMode"));
}

/* Calls of clocks and scheduled execution. */

#define ABSENT(NAME, ...)                                                                          \
    STICKSLIP_EXPORT fmi3Status FMI3(NAME)(fmi3Instance instance, __VA_ARGS__)                     \
    {                                                                                              \
        return status_of(instance_absent(instance, #NAME));                                        \
    }

#define ABSENT_MODE(NAME)                                                                          \
    STICKSLIP_EXPORT fmi3Status FMI3(NAME)(fmi3Instance instance)                                  \
    {                                                                                              \
        return status_of(instance_absent(instance, #NAME));                                        \
    }

ABSENT_MODE(fmi3EvaluateDiscreteStates)

ABSENT(fmi3GetClock, const fmi3ValueReference references[] IGNORED, size_t count IGNORED,
       fmi3Clock values[] IGNORED)
ABSENT(fmi3SetClock, const fmi3ValueReference references[] IGNORED, size_t count IGNORED,
       const fmi3Clock values[] IGNORED)
ABSENT(fmi3GetIntervalDecimal, const fmi3ValueReference references[] IGNORED, size_t count IGNORED,
       fmi3Float64 intervals[] IGNORED, fmi3IntervalQualifier qualifiers[] IGNORED)
ABSENT(fmi3GetIntervalFraction, const fmi3ValueReference references[] IGNORED,
       size_t count IGNORED, fmi3UInt64 counters[] IGNORED, fmi3UInt64 resolutions[] IGNORED,
       fmi3IntervalQualifier qualifiers[] IGNORED)
ABSENT(fmi3GetShiftDecimal, const fmi3ValueReference references[] IGNORED, size_t count IGNORED,
       fmi3Float64 shifts[] IGNORED)
ABSENT(fmi3GetShiftFraction, const fmi3ValueReference references[] IGNORED, size_t count IGNORED,
       fmi3UInt64 counters[] IGNORED, fmi3UInt64 resolutions[] IGNORED)
ABSENT(fmi3SetIntervalDecimal, const fmi3ValueReference references[] IGNORED, size_t count IGNORED,
       const fmi3Float64 intervals[] IGNORED)
ABSENT(fmi3SetIntervalFraction, const fmi3ValueReference references[] IGNORED,
       size_t count IGNORED, const fmi3UInt64 counters[] IGNORED,
       const fmi3UInt64 resolutions[] IGNORED)
ABSENT(fmi3SetShiftDecimal, const fmi3ValueReference references[] IGNORED, size_t count IGNORED,
       const fmi3Float64 shifts[] IGNORED)
ABSENT(fmi3SetShiftFraction, const fmi3ValueReference references[] IGNORED, size_t count IGNORED,
       const fmi3UInt64 counters[] IGNORED, const fmi3UInt64 resolutions[] IGNORED)

ABSENT(fmi3ActivateModelPartition, fmi3ValueReference clock IGNORED,
       fmi3Float64 activation_time IGNORED)
