/* The calls in FMI 3.0: see the header. */
#include "face.h"

#include "fmi3FunctionTypes.h"

static fmi3InstantiateCoSimulationTYPE *instantiate;
static fmi3EnterInitializationModeTYPE *enter;
static fmi3DoStepTYPE *step;
static fmi3SetFloat64TYPE *set_real;
static fmi3GetFloat64TYPE *get_real;
static fmi3GetInt32TYPE *get_integer;
static fmi3GetInt64TYPE *get_enumeration;
static fmi3GetBooleanTYPE *get_boolean;

const struct function FUNCTIONS[] = {
    {"fmi3InstantiateCoSimulation", &instantiate},
    {"fmi3FreeInstance", &face_free},
    {"fmi3EnterInitializationMode", &enter},
    {"fmi3ExitInitializationMode", &face_exit},
    {"fmi3Terminate", &face_terminate},
    {"fmi3Reset", &face_reset},
    {"fmi3DoStep", &step},
    {"fmi3SetFloat64", &set_real},
    {"fmi3GetFloat64", &get_real},
    {"fmi3GetInt32", &get_integer},
    {"fmi3GetInt64", &get_enumeration},
    {"fmi3GetBoolean", &get_boolean},
    {"fmi3GetFMUState", &face_get_state},
    {"fmi3SetFMUState", &face_set_state},
    {"fmi3FreeFMUState", &face_free_state},
    {"fmi3SerializedFMUStateSize", &face_state_size},
    {"fmi3SerializeFMUState", &face_write_state},
    {"fmi3DeserializeFMUState", &face_read_state},
};
const size_t FUNCTION_COUNT = sizeof FUNCTIONS / sizeof *FUNCTIONS;

enum { MOST = 64 };

static double start;

static void log_message(fmi3InstanceEnvironment environment, fmi3Status status,
                        fmi3String category, fmi3String text)
{
    (void)environment;
    show("block", (int)status, category, text);
}

void *face_make(const char *identity)
{
    return instantiate("block", identity, NULL, fmi3False, fmi3True, fmi3False, fmi3False, NULL, 0,
                       NULL, log_message, NULL);
}

int face_setup(void *slave, double start_time)
{
    (void)slave;
    start = start_time;
    return fmi3OK;
}

int face_enter(void *slave)
{
    return enter(slave, fmi3False, 0.0, start, fmi3False, 0.0);
}

int face_step(void *slave, double time, double length)
{
    fmi3Boolean needs_event, terminates, early;
    fmi3Float64 reached;
    return step(slave, time, length, fmi3False, &needs_event, &terminates, &early, &reached);
}

int face_set(void *slave, const unsigned references[], size_t count, const double values[])
{
    return set_real(slave, references, count, values, count);
}

int face_real(void *slave, const unsigned references[], size_t count, double values[])
{
    return get_real(slave, references, count, values, count);
}

int face_integer(void *slave, const unsigned references[], size_t count, int values[])
{
    return get_integer(slave, references, count, values, count);
}

int face_enumeration(void *slave, const unsigned references[], size_t count, int values[])
{
    fmi3Int64 wide[MOST] = {0};
    const fmi3Status status = get_enumeration(slave, references, count, wide, count);
    for (size_t n = 0; n < count; n++) values[n] = (int)wide[n];
    return status;
}

int face_boolean(void *slave, const unsigned references[], size_t count, int values[])
{
    fmi3Boolean truths[MOST] = {0};
    const fmi3Status status = get_boolean(slave, references, count, truths, count);
    for (size_t n = 0; n < count; n++) values[n] = truths[n];
    return status;
}
