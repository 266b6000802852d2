/* A harness for libFuzzer: any bytes as a state of the native FMU, with head and checksum repaired.
 *
 * A state that is taken must be written and read again as it is, and the instance must answer the
 * calls that follow, or refuse them. */
#include "bytes.h"
#include "fmi2_types.h"
#include "identity.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid,
                              fmi2String resources, const fmi2CallbackFunctions *callbacks,
                              fmi2Boolean visible, fmi2Boolean logging_on);
void fmi2FreeInstance(fmi2Component c);
fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference references[], size_t count,
                       fmi2Real values[]);
fmi2Status fmi2GetInteger(fmi2Component c, const fmi2ValueReference references[], size_t count,
                          fmi2Integer values[]);
fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference references[], size_t count,
                       const fmi2Real values[]);
fmi2Status fmi2EnterInitializationMode(fmi2Component c);
fmi2Status fmi2ExitInitializationMode(fmi2Component c);
fmi2Status fmi2DoStep(fmi2Component c, fmi2Real time, fmi2Real step, fmi2Boolean no_earlier);
fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate state);
fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *state);
fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate state, fmi2Byte bytes[],
                                 size_t size);
fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte bytes[], size_t size,
                                   fmi2FMUstate *state);
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

enum { HEAD = 24, HASH = 8, STEPS = 3 };

static void check(int holds)
{
    if (!holds) abort();
}

/* Write head and checksum of a state about `body`. */
static unsigned char *repaired(const uint8_t *body, size_t size)
{
    const size_t count = bytes_count();
    const struct situation none = {.time = 0.0};
    unsigned char *bytes = calloc(1, count);
    check(bytes != NULL);
    bytes_write(&none, bytes);
    if (size > count - HEAD - HASH) size = count - HEAD - HASH;
    memcpy(bytes + HEAD, body, size);
    const uint64_t hash = hash_of(bytes, count - HASH);
    for (int n = 0; n < HASH; n++) bytes[count - HASH + (size_t)n] = (unsigned char)(hash >> 8 * n);
    return bytes;
}

/* Live on from a state. */
static void live(fmi2Component instance)
{
    static const double steps[STEPS] = {1e-6, 1e-3, 0.1};
    const fmi2ValueReference pull = VR_v;
    const double speed = -0.01;
    double time = 0.0, real;
    int integer;
    fmi2ExitInitializationMode(instance);
    for (int n = 0; n < STEPS; n++) {
        for (fmi2ValueReference each = 0; each < VARIABLES; each++) {
            const enum kind kind = ROWS[each].kind;
            if (kind == REAL && fmi2GetReal(instance, &each, 1, &real) != fmi2OK) return;
            if (kind == INTEGER && fmi2GetInteger(instance, &each, 1, &integer) != fmi2OK) return;
        }
        if (fmi2DoStep(instance, time, steps[n], 1) != fmi2OK) return;
        time += steps[n];
        fmi2SetReal(instance, &pull, 1, &speed);
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    const size_t count = bytes_count();
    fmi2FMUstate state = NULL, again = NULL;
    const fmi2Component instance = fmi2Instantiate("fuzzed", fmi2CoSimulation, STICKSLIP_IDENTITY,
                                                   NULL, NULL, 0, 0);
    check(instance != NULL);
    /* As they are: the head and the checksum nearly always tell. */
    if (fmi2DeSerializeFMUstate(instance, (const fmi2Byte *)data, size, &state) == fmi2OK)
        fmi2FreeFMUstate(instance, &state);
    fmi2FreeInstance(instance);

    const fmi2Component other = fmi2Instantiate("fuzzed", fmi2CoSimulation, STICKSLIP_IDENTITY,
                                                NULL, NULL, 0, 0);
    unsigned char *bytes = repaired(data, size);
    fmi2Byte *first = malloc(count), *second = malloc(count);
    check(other != NULL && first != NULL && second != NULL);
    if (fmi2DeSerializeFMUstate(other, (const fmi2Byte *)bytes, count, &state) == fmi2OK) {
        check(fmi2SerializeFMUstate(other, state, first, count) == fmi2OK);
        check(fmi2DeSerializeFMUstate(other, first, count, &again) == fmi2OK);
        check(fmi2SerializeFMUstate(other, again, second, count) == fmi2OK);
        check(memcmp(first, second, count) == 0);
        check(fmi2SetFMUstate(other, again) == fmi2OK);
        live(other);
        fmi2FreeFMUstate(other, &state);
        fmi2FreeFMUstate(other, &again);
    }
    free(first);
    free(second);
    free(bytes);
    fmi2FreeInstance(other);
    return 0;
}
