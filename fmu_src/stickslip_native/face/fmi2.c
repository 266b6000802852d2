/* The functions of FMI 2.0, for co-simulation or for model exchange as identity.h has it.
 *
 * A call that is refused returns fmi2Error, and the instance refuses all that depends on its motion
 * until fmi2Reset or fmi2SetFMUstate: instance.h. The memory functions of the simulator are not
 * used. `loggingOn` is about debug messages, and there are none: warnings and errors reach the log
 * until fmi2SetDebugLogging says otherwise. */
#include "export.h"
#include "fmi2_types.h"
#include "identity.h"
#include "instance.h"

#include <float.h>
#include <stddef.h>

static const struct type Real = {"Real", 1u << SORT_REAL, STICKSLIP_MODEL_EXCHANGE};
static const struct type Integer = {"Integer", 1u << SORT_INTEGER | 1u << SORT_ENUMERATION, false};
static const struct type Boolean = {"Boolean", 1u << SORT_BOOLEAN, false};
static const struct type String = {"String", 0, false};

static fmi2Status status_of(bool taken)
{
    return taken ? fmi2OK : fmi2Error;
}

/* Hand a message to the simulator, whose logger takes it for a printf format: each % is doubled.
 * A format "%s" with the message behind it would not reach loggers without printf. */
static void log_message(const struct instance *it, enum status status, const char *category,
                        const char *text)
{
    char format[2 * MESSAGE_SIZE];
    size_t length = 0;
    for (; *text != '\0' && length + 2 < sizeof format; text++) {
        if (*text == '%') format[length++] = '%';
        format[length++] = *text;
    }
    format[length] = '\0';
    ((fmi2CallbackLogger)it->logger)(it->environment, it->name, (fmi2Status)status, category,
                                     format);
}

static const struct version FMI2_VERSION = {
    {"Real", "Integer", "Boolean", "Integer"}, "GUID", log_message};

/* Versions and log. */

STICKSLIP_EXPORT const char *FMI2(fmi2GetTypesPlatform)(void)
{
    return "default";
}

STICKSLIP_EXPORT const char *FMI2(fmi2GetVersion)(void)
{
    return "2.0";
}

STICKSLIP_EXPORT fmi2Status FMI2(fmi2SetDebugLogging)(fmi2Component c, fmi2Boolean on,
                                                      size_t count, const fmi2String categories[])
{
    return status_of(instance_log(c, "fmi2SetDebugLogging", on != 0, count, categories));
}

/* Instances. */

STICKSLIP_EXPORT fmi2Component FMI2(fmi2Instantiate)(fmi2String name, fmi2Type type,
                                                     fmi2String guid, fmi2String resources IGNORED,
                                                     const fmi2CallbackFunctions *callbacks,
                                                     fmi2Boolean visible IGNORED,
                                                     fmi2Boolean logging_on IGNORED)
{
    static const fmi2CallbackFunctions NONE = {NULL, NULL, NULL, NULL, NULL};
    if (callbacks == NULL) callbacks = &NONE;
    struct instance *made =
        instance_make(&FMI2_VERSION, "fmi2Instantiate", name, STICKSLIP_IDENTITY, guid,
                      (void (*)(void))callbacks->logger, callbacks->componentEnvironment);
    if (made == NULL) return NULL;
    if (type == (STICKSLIP_MODEL_EXCHANGE ? fmi2ModelExchange : fmi2CoSimulation)) {
        made->solves = STICKSLIP_MODEL_EXCHANGE;
        return made;
    }
    instance_fail(made, STICKSLIP_MODEL_EXCHANGE
                            ? "fmi2Instantiate: co-simulation is in an FMU of its own"
                            : "fmi2Instantiate: model exchange is in an FMU of its own");
    instance_free(made);
    return NULL;
}

STICKSLIP_EXPORT void FMI2(fmi2FreeInstance)(fmi2Component c)
{
    instance_free(c);
}

/* Phases. */

STICKSLIP_EXPORT fmi2Status FMI2(fmi2SetupExperiment)(fmi2Component c,
                                                      fmi2Boolean tolerance_defined IGNORED,
                                                      fmi2Real tolerance IGNORED,
                                                      fmi2Real start_time,
                                                      fmi2Boolean stop_time_defined IGNORED,
                                                      fmi2Real stop_time IGNORED)
{
    return status_of(instance_set_start(c, start_time));
}

#define PHASE(NAME, FUNCTION)                                                                      \
    STICKSLIP_EXPORT fmi2Status FMI2(NAME)(fmi2Component c)                                        \
    {                                                                                              \
        return status_of(FUNCTION(c));                                                             \
    }

PHASE(fmi2EnterInitializationMode, instance_enter_initialization)
PHASE(fmi2ExitInitializationMode, instance_exit_initialization)
PHASE(fmi2Terminate, instance_terminate)
PHASE(fmi2Reset, instance_reset)

/* Values. No variable is a String, so no text is read or written. */

#define VALUES(NAME)                                                                               \
    STICKSLIP_EXPORT fmi2Status FMI2(fmi2Get##NAME)(                                               \
        fmi2Component c, const fmi2ValueReference references[], size_t count,                      \
        fmi2##NAME values[])                                                                       \
    {                                                                                              \
        double value;                                                                              \
        if (!instance_begin_get(c, "fmi2Get" #NAME, &NAME, references, count, values, count))      \
            return fmi2Error;                                                                      \
        for (size_t n = 0; n < count; n++) {                                                       \
            if (!instance_get(c, &NAME, references, count, n, &value)) return fmi2Error;           \
            values[n] = (fmi2##NAME)value;                                                         \
        }                                                                                          \
        return fmi2OK;                                                                             \
    }                                                                                              \
                                                                                                   \
    STICKSLIP_EXPORT fmi2Status FMI2(fmi2Set##NAME)(                                               \
        fmi2Component c, const fmi2ValueReference references[], size_t count,                      \
        const fmi2##NAME values[])                                                                 \
    {                                                                                              \
        if (!instance_begin_set(c, "fmi2Set" #NAME, &NAME, references, count, values, count))      \
            return fmi2Error;                                                                      \
        for (size_t n = 0; n < count; n++)                                                         \
            if (!instance_set(c, &NAME, references[n], (double)values[n])) return fmi2Error;       \
        return status_of(instance_end_set(c));                                                     \
    }

VALUES(Real)
VALUES(Integer)
VALUES(Boolean)

STICKSLIP_EXPORT fmi2Status FMI2(fmi2GetString)(fmi2Component c,
                                                const fmi2ValueReference references[],
                                                size_t count, fmi2String values[])
{
    double none;
    if (!instance_begin_get(c, "fmi2GetString", &String, references, count, values, count))
        return fmi2Error;
    return status_of(count == 0 || instance_get(c, &String, references, count, 0, &none));
}

STICKSLIP_EXPORT fmi2Status FMI2(fmi2SetString)(fmi2Component c,
                                                const fmi2ValueReference references[],
                                                size_t count, const fmi2String values[])
{
    if (!instance_begin_set(c, "fmi2SetString", &String, references, count, values, count))
        return fmi2Error;
    return status_of(count == 0 || instance_set(c, &String, references[0], 0.0));
}

/* States. */

STICKSLIP_EXPORT fmi2Status FMI2(fmi2GetFMUstate)(fmi2Component c, fmi2FMUstate *state)
{
    return status_of(instance_get_state(c, "fmi2GetFMUstate", state));
}

STICKSLIP_EXPORT fmi2Status FMI2(fmi2SetFMUstate)(fmi2Component c, fmi2FMUstate state)
{
    return status_of(instance_set_state(c, state));
}

STICKSLIP_EXPORT fmi2Status FMI2(fmi2FreeFMUstate)(fmi2Component c, fmi2FMUstate *state)
{
    return status_of(instance_free_state(c, "fmi2FreeFMUstate", state));
}

STICKSLIP_EXPORT fmi2Status FMI2(fmi2SerializedFMUstateSize)(fmi2Component c, fmi2FMUstate state,
                                                             size_t *size)
{
    return status_of(instance_state_size(c, "fmi2SerializedFMUstateSize", state, size));
}

STICKSLIP_EXPORT fmi2Status FMI2(fmi2SerializeFMUstate)(fmi2Component c, fmi2FMUstate state,
                                                        fmi2Byte bytes[], size_t size)
{
    return status_of(instance_write_state(c, "fmi2SerializeFMUstate", state,
                                          (unsigned char *)bytes, size));
}

STICKSLIP_EXPORT fmi2Status FMI2(fmi2DeSerializeFMUstate)(fmi2Component c, const fmi2Byte bytes[],
                                                          size_t size, fmi2FMUstate *state)
{
    return status_of(instance_read_state(c, "fmi2DeSerializeFMUstate",
                                         (const unsigned char *)bytes, size, state));
}

/* Calls that the FMU does not offer. */

STICKSLIP_EXPORT fmi2Status FMI2(fmi2GetDirectionalDerivative)(
    fmi2Component c, const fmi2ValueReference unknowns[] IGNORED, size_t unknown_count IGNORED,
    const fmi2ValueReference knowns[] IGNORED, size_t known_count IGNORED,
    const fmi2Real seed[] IGNORED, fmi2Real sensitivity[] IGNORED)
{
    return status_of(instance_unsupported(c, "fmi2GetDirectionalDerivative"));
}

#if STICKSLIP_MODEL_EXCHANGE

/* Model exchange. */

STICKSLIP_EXPORT fmi2Status FMI2(fmi2EnterEventMode)(fmi2Component c)
{
    return status_of(instance_enter_event_mode(c, "fmi2EnterEventMode"));
}

STICKSLIP_EXPORT fmi2Status FMI2(fmi2NewDiscreteStates)(fmi2Component c, fmi2EventInfo *info)
{
    static const char *const CALL = "fmi2NewDiscreteStates";
    double next;
    if (c == NULL || !instance_given(c, CALL, "eventInfo", info) ||
        !instance_update(c, CALL, &next))
        return fmi2Error;
    /* A solver that is not told so goes on with what it knew of the arc before. */
    *info = (fmi2EventInfo){.nominalsOfContinuousStatesChanged = 1,
                            .valuesOfContinuousStatesChanged = 1,
                            .nextEventTimeDefined = next < DBL_MAX,
                            .nextEventTime = next};
    return fmi2OK;
}

STICKSLIP_EXPORT fmi2Status FMI2(fmi2EnterContinuousTimeMode)(fmi2Component c)
{
    return status_of(instance_enter_continuous(c, "fmi2EnterContinuousTimeMode"));
}

STICKSLIP_EXPORT fmi2Status FMI2(fmi2SetTime)(fmi2Component c, fmi2Real time)
{
    return status_of(instance_set_time(c, "fmi2SetTime", time));
}

STICKSLIP_EXPORT fmi2Status FMI2(fmi2CompletedIntegratorStep)(
    fmi2Component c, fmi2Boolean no_earlier_state IGNORED, fmi2Boolean *enter_event_mode,
    fmi2Boolean *terminate)
{
    static const char *const CALL = "fmi2CompletedIntegratorStep";
    if (!instance_complete_step(c, CALL) ||
        !instance_given(c, CALL, "enterEventMode", enter_event_mode) ||
        !instance_given(c, CALL, "terminateSimulation", terminate))
        return fmi2Error;
    *enter_event_mode = *terminate = 0;
    return fmi2OK;
}

#define ARRAY(NAME, FUNCTION, CONST)                                                               \
    STICKSLIP_EXPORT fmi2Status FMI2(NAME)(fmi2Component c, CONST fmi2Real values[], size_t count) \
    {                                                                                              \
        const struct instance *it = c;                                                             \
        if (FUNCTION(c, #NAME, values, count)) return fmi2OK;                                      \
        return it != NULL && it->discards ? fmi2Discard : fmi2Error;                               \
    }

ARRAY(fmi2SetContinuousStates, instance_set_states, const)
ARRAY(fmi2GetContinuousStates, instance_get_states, )
ARRAY(fmi2GetDerivatives, instance_get_rates, )
ARRAY(fmi2GetNominalsOfContinuousStates, instance_get_nominals, )
ARRAY(fmi2GetEventIndicators, instance_get_indicators, )

#else

/* Co-simulation. */

STICKSLIP_EXPORT fmi2Status FMI2(fmi2DoStep)(fmi2Component c, fmi2Real time, fmi2Real step,
                                             fmi2Boolean no_earlier_state IGNORED)
{
    return (fmi2Status)instance_step(c, time, step);
}

STICKSLIP_EXPORT fmi2Status FMI2(fmi2SetRealInputDerivatives)(
    fmi2Component c, const fmi2ValueReference references[], size_t count,
    const fmi2Integer orders[], const fmi2Real values[])
{
    return status_of(instance_set_rates(c, "fmi2SetRealInputDerivatives", references, count, orders,
                                        values));
}

STICKSLIP_EXPORT fmi2Status FMI2(fmi2GetRealOutputDerivatives)(
    fmi2Component c, const fmi2ValueReference references[] IGNORED, size_t count IGNORED,
    const fmi2Integer orders[] IGNORED, fmi2Real values[] IGNORED)
{
    return status_of(instance_unsupported(c, "fmi2GetRealOutputDerivatives"));
}

STICKSLIP_EXPORT fmi2Status FMI2(fmi2CancelStep)(fmi2Component c)
{
    return status_of(instance_unsupported(c, "fmi2CancelStep"));
}

/* Status of the last step: no step is ever pending, and none ends the simulation. These calls do
 * not depend on the motion. */

#define NO_STATUS(NAME, TYPE)                                                                      \
    STICKSLIP_EXPORT fmi2Status FMI2(NAME)(fmi2Component c, const fmi2StatusKind kind IGNORED,     \
                                           TYPE *value IGNORED)                                    \
    {                                                                                              \
        return c == NULL ? fmi2Error : fmi2Discard;                                                \
    }

NO_STATUS(fmi2GetStatus, fmi2Status)
NO_STATUS(fmi2GetIntegerStatus, fmi2Integer)
NO_STATUS(fmi2GetStringStatus, fmi2String)

STICKSLIP_EXPORT fmi2Status FMI2(fmi2GetRealStatus)(fmi2Component c, const fmi2StatusKind kind,
                                                    fmi2Real *value)
{
    struct instance *it = c;
    if (it == NULL) return fmi2Error;
    if (kind != fmi2LastSuccessfulTime) return fmi2Discard;
    if (!instance_given(it, "fmi2GetRealStatus", "value", value)) return fmi2Error;
    *value = it->now.time;
    return fmi2OK;
}

STICKSLIP_EXPORT fmi2Status FMI2(fmi2GetBooleanStatus)(fmi2Component c, const fmi2StatusKind kind,
                                                       fmi2Boolean *value)
{
    struct instance *it = c;
    if (it == NULL) return fmi2Error;
    if (kind != fmi2Terminated) return fmi2Discard;
    if (!instance_given(it, "fmi2GetBooleanStatus", "value", value)) return fmi2Error;
    *value = 0;
    return fmi2OK;
}

#endif
