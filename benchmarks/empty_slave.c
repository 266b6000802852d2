/* The yardstick in C: an FMU 2.0 for co-simulation that takes every call and does nothing. */
#include <stddef.h>
#include <stdlib.h>

enum { STATE_BYTES = 64 };

void *fmi2Instantiate(const char *name, int type, const char *guid, const char *resources,
                      const void *callbacks, int visible, int logging)
{
    (void)name, (void)type, (void)guid, (void)resources, (void)callbacks, (void)visible;
    (void)logging;
    return malloc(1);
}
void fmi2FreeInstance(void *slave) { free(slave); }

int fmi2EnterInitializationMode(void *slave) { (void)slave; return 0; }
int fmi2ExitInitializationMode(void *slave) { (void)slave; return 0; }
int fmi2Reset(void *slave) { (void)slave; return 0; }
int fmi2SetupExperiment(void *slave, int tolerant, double tolerance, double start, int stops,
                        double stop)
{
    (void)slave, (void)tolerant, (void)tolerance, (void)start, (void)stops, (void)stop;
    return 0;
}
int fmi2DoStep(void *slave, double time, double step, int no_set_before)
{
    (void)slave, (void)time, (void)step, (void)no_set_before;
    return 0;
}
int fmi2GetReal(void *slave, const unsigned *references, size_t count, double *values)
{
    (void)slave, (void)references;
    for (size_t n = 0; n < count; n++) values[n] = 0.0;
    return 0;
}
int fmi2SetReal(void *slave, const unsigned *references, size_t count, const double *values)
{
    (void)slave, (void)references, (void)count, (void)values;
    return 0;
}
int fmi2GetFMUstate(void *slave, void **state)
{
    (void)slave;
    *state = malloc(STATE_BYTES);
    return 0;
}
int fmi2SetFMUstate(void *slave, void *state)
{
    (void)slave, (void)state;
    return 0;
}
int fmi2FreeFMUstate(void *slave, void **state)
{
    (void)slave;
    free(*state);
    *state = NULL;
    return 0;
}
int fmi2SerializedFMUstateSize(void *slave, void *state, size_t *size)
{
    (void)slave, (void)state;
    *size = STATE_BYTES;
    return 0;
}
int fmi2SerializeFMUstate(void *slave, void *state, char *bytes, size_t size)
{
    (void)slave, (void)state;
    for (size_t n = 0; n < size; n++) bytes[n] = 0;
    return 0;
}
int fmi2DeSerializeFMUstate(void *slave, const char *bytes, size_t size, void **state)
{
    (void)bytes, (void)size;
    return fmi2GetFMUstate(slave, state);
}
