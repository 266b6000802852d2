/* The calls in FMI 2.0: see the header. */
#include "face.h"

#include "fmi2FunctionTypes.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

static fmi2InstantiateTYPE *instantiate;
static fmi2SetupExperimentTYPE *setup;
static fmi2EnterInitializationModeTYPE *enter;
static fmi2DoStepTYPE *step;
static fmi2SetRealTYPE *set_real;
static fmi2GetRealTYPE *get_real;
static fmi2GetIntegerTYPE *get_integer;
static fmi2GetBooleanTYPE *get_boolean;

const struct function FUNCTIONS[] = {
    {"fmi2Instantiate", &instantiate},
    {"fmi2FreeInstance", &face_free},
    {"fmi2SetupExperiment", &setup},
    {"fmi2EnterInitializationMode", &enter},
    {"fmi2ExitInitializationMode", &face_exit},
    {"fmi2Terminate", &face_terminate},
    {"fmi2Reset", &face_reset},
    {"fmi2DoStep", &step},
    {"fmi2SetReal", &set_real},
    {"fmi2GetReal", &get_real},
    {"fmi2GetInteger", &get_integer},
    {"fmi2GetBoolean", &get_boolean},
    {"fmi2GetFMUstate", &face_get_state},
    {"fmi2SetFMUstate", &face_set_state},
    {"fmi2FreeFMUstate", &face_free_state},
    {"fmi2SerializedFMUstateSize", &face_state_size},
    {"fmi2SerializeFMUstate", &face_write_state},
    {"fmi2DeSerializeFMUstate", &face_read_state},
};
const size_t FUNCTION_COUNT = sizeof FUNCTIONS / sizeof *FUNCTIONS;

/* The text is a printf format with its arguments. */
static void log_message(fmi2ComponentEnvironment environment, fmi2String instance,
                        fmi2Status status, fmi2String category, fmi2String format, ...)
{
    char text[4096];
    va_list arguments;
    (void)environment;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    show(instance, (int)status, category, text);
}

void *face_make(const char *identity)
{
    static const fmi2CallbackFunctions CALLBACKS = {log_message, calloc, free, NULL, NULL};
    return instantiate("block", fmi2CoSimulation, identity, NULL, &CALLBACKS, fmi2False, fmi2True);
}

int face_setup(void *slave, double start_time)
{
    return setup(slave, fmi2False, 0.0, start_time, fmi2False, 0.0);
}

int face_enter(void *slave)
{
    return enter(slave);
}

int face_step(void *slave, double time, double length)
{
    return step(slave, time, length, fmi2False);
}

int face_set(void *slave, const unsigned references[], size_t count, const double values[])
{
    return set_real(slave, references, count, values);
}

int face_real(void *slave, const unsigned references[], size_t count, double values[])
{
    return get_real(slave, references, count, values);
}

int face_integer(void *slave, const unsigned references[], size_t count, int values[])
{
    return get_integer(slave, references, count, values);
}

int face_enumeration(void *slave, const unsigned references[], size_t count, int values[])
{
    return get_integer(slave, references, count, values);
}

int face_boolean(void *slave, const unsigned references[], size_t count, int values[])
{
    return get_boolean(slave, references, count, values);
}
