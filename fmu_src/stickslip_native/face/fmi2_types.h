/* Types of FMI 2.0.5, sections 2.1, 3.2 and 4.2. */
#ifndef STICKSLIP_FMI2_TYPES_H
#define STICKSLIP_FMI2_TYPES_H

#include <stddef.h>

typedef void *fmi2Component;
typedef void *fmi2ComponentEnvironment;
typedef void *fmi2FMUstate;
typedef unsigned int fmi2ValueReference;
typedef double fmi2Real;
typedef int fmi2Integer;
typedef int fmi2Boolean;
typedef const char *fmi2String;
typedef char fmi2Byte;

typedef enum { fmi2OK, fmi2Warning, fmi2Discard, fmi2Error, fmi2Fatal, fmi2Pending } fmi2Status;

typedef enum { fmi2ModelExchange, fmi2CoSimulation } fmi2Type;

typedef enum {
    fmi2DoStepStatus,
    fmi2PendingStatus,
    fmi2LastSuccessfulTime,
    fmi2Terminated
} fmi2StatusKind;

typedef void (*fmi2CallbackLogger)(fmi2ComponentEnvironment environment, fmi2String name,
                                   fmi2Status status, fmi2String category, fmi2String message,
                                   ...);

typedef struct {
    fmi2CallbackLogger logger;
    void *(*allocateMemory)(size_t count, size_t size);
    void (*freeMemory)(void *memory);
    void (*stepFinished)(fmi2ComponentEnvironment environment, fmi2Status status);
    fmi2ComponentEnvironment componentEnvironment;
} fmi2CallbackFunctions;

typedef struct {
    fmi2Boolean newDiscreteStatesNeeded;
    fmi2Boolean terminateSimulation;
    fmi2Boolean nominalsOfContinuousStatesChanged;
    fmi2Boolean valuesOfContinuousStatesChanged;
    fmi2Boolean nextEventTimeDefined;
    fmi2Real nextEventTime;
} fmi2EventInfo;

/* A library that is linked statically has the name of the model before each function. */
#if defined FMI2_OVERRIDE_FUNCTION_PREFIX && defined FMI2_ACTUAL_FUNCTION_PREFIX
#define FMI2(name) STICKSLIP_PREFIXED(FMI2_ACTUAL_FUNCTION_PREFIX, name)
#elif !defined FMI2_OVERRIDE_FUNCTION_PREFIX && defined FMI2_FUNCTION_PREFIX
#define FMI2(name) STICKSLIP_PREFIXED(FMI2_FUNCTION_PREFIX, name)
#else
#define FMI2(name) name
#endif

#endif
