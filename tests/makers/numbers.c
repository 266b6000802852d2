/* A foreign FMU 3.0 with one variable of each type of number, which keep what they are given.

   Its step meets an event each time, and returns after one second if it is longer. */
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

static int instance;

void *fmi3InstantiateCoSimulation(void) { return &instance; }

int fmi3DoStep(void *i, double time, double h, bool no_set, bool *event, bool *terminate,
               bool *early, double *reached) {
    *event = true;
    *early = h > 1.0;
    *reached = time + 1.0;
    return 0;
}

#define ACCESS(kind, type)                                                                         \
    static type of_##kind[20];                                                                     \
    int fmi3Get##kind(void *i, const unsigned *which, size_t n, type *values, size_t m) {          \
        for (size_t j = 0; j < n; j++) values[j] = of_##kind[which[j]];                            \
        return n == m ? 0 : 3;                                                                     \
    }                                                                                              \
    int fmi3Set##kind(void *i, const unsigned *which, size_t n, const type *values, size_t m) {    \
        for (size_t j = 0; j < n; j++) of_##kind[which[j]] = values[j];                            \
        return n == m ? 0 : 3;                                                                     \
    }

ACCESS(Float32, float)
ACCESS(Float64, double)
ACCESS(Int8, int8_t)
ACCESS(UInt8, uint8_t)
ACCESS(Int16, int16_t)
ACCESS(UInt16, uint16_t)
ACCESS(Int32, int32_t)
ACCESS(UInt32, uint32_t)
ACCESS(Int64, int64_t)
ACCESS(UInt64, uint64_t)
ACCESS(Boolean, bool)

/* FMPy asks for every function of the standard. */
#define EMPTY(name) int fmi3##name(void) { return 0; }
EMPTY(ActivateModelPartition) EMPTY(CompletedIntegratorStep) EMPTY(DeserializeFMUState)
EMPTY(EnterConfigurationMode) EMPTY(EnterContinuousTimeMode) EMPTY(EnterEventMode)
EMPTY(EnterInitializationMode) EMPTY(EnterStepMode) EMPTY(EvaluateDiscreteStates)
EMPTY(ExitConfigurationMode) EMPTY(ExitInitializationMode) EMPTY(FreeFMUState) EMPTY(FreeInstance)
EMPTY(GetAdjointDerivative) EMPTY(GetBinary) EMPTY(GetClock) EMPTY(GetContinuousStateDerivatives)
EMPTY(GetContinuousStates) EMPTY(GetDirectionalDerivative) EMPTY(GetEventIndicators)
EMPTY(GetFMUState) EMPTY(GetIntervalDecimal) EMPTY(GetIntervalFraction)
EMPTY(GetNominalsOfContinuousStates) EMPTY(GetNumberOfContinuousStates)
EMPTY(GetNumberOfEventIndicators) EMPTY(GetNumberOfVariableDependencies) EMPTY(GetOutputDerivatives)
EMPTY(GetShiftDecimal) EMPTY(GetShiftFraction) EMPTY(GetString) EMPTY(GetVariableDependencies)
EMPTY(GetVersion) EMPTY(InstantiateModelExchange) EMPTY(InstantiateScheduledExecution) EMPTY(Reset)
EMPTY(SerializeFMUState) EMPTY(SerializedFMUStateSize) EMPTY(SetBinary) EMPTY(SetClock)
EMPTY(SetContinuousStates) EMPTY(SetDebugLogging) EMPTY(SetFMUState) EMPTY(SetIntervalDecimal)
EMPTY(SetIntervalFraction) EMPTY(SetShiftDecimal) EMPTY(SetShiftFraction) EMPTY(SetString)
EMPTY(SetTime) EMPTY(Terminate) EMPTY(UpdateDiscreteStates)
