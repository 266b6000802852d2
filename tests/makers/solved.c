/* A foreign FMU 2.0 that the importer solves: a slider as people write it, without a meter.

   NOMINAL is the nominal value of its states, FRICTION a factor on friction in slip, CREEP a speed in
   stick. It finds events by an indicator, by STEPS when one of the solver is over, or BLINDLY not.
   STATUS is that of derivatives after 50 ms; it wants its states updated AGAIN, events BEHIND it, and
   is SILENT of states that change. */
#include <math.h>
#include <stdlib.h>

/* As in the list of variables, then the states and their derivatives. */
enum { M, G, K, C, MU_S, MU_K, X_START, X_DOT_START, Z_START, V, LOAD, F_EXT, X, X_DOT, X_PULL, F,
       FRICTION_FORCE, ALL };

struct slider { double of[ALL], time; int mode; };

static double force(const double *of) { return of[K] * (of[X_PULL] - of[X]); }
static double hold(const double *of) { return of[MU_S] * (of[M] * of[G] + of[LOAD]); }

static double friction(const struct slider *it) {
    const double *of = it->of, mu_k = fmin(of[MU_K], of[MU_S]);
    return it->mode * FRICTION * mu_k * (of[M] * of[G] + of[LOAD]) + of[C] * of[X_DOT];
}

static double indicator(const struct slider *it) {
    const double *of = it->of;
    return it->mode ? it->mode * of[X_DOT] : hold(of) - fabs(force(of) + of[F_EXT]);
}

void *fmi2Instantiate(const char *n, int t, const char *g, const char *r, const void *f, int v, int l) {
    struct slider *it = calloc(1, sizeof *it);
    const double start[] = {1.0, 9.81, 1000.0, 0.0, 0.5, 0.3, 0.0, 0.0, 0.0, 0.02, 0.0, 0.0};
    for (int i = 0; i <= F_EXT; i++) it->of[i] = start[i];
    return it;
}

void fmi2FreeInstance(struct slider *it) { free(it); }

int fmi2SetupExperiment(struct slider *it, int t, double tolerance, double start, int e, double end) {
    return 0;
}

int fmi2EnterInitializationMode(struct slider *it) { return 0; }

int fmi2ExitInitializationMode(struct slider *it) {
    double *of = it->of;
    of[X] = of[X_START];
    of[X_DOT] = of[X_DOT_START];
    of[X_PULL] = of[X_START] + of[Z_START];
    it->mode = (of[X_DOT] > 0.0) - (of[X_DOT] < 0.0);
    return 0;
}

int fmi2SetReal(struct slider *it, const unsigned *which, size_t n, const double *values) {
    for (size_t i = 0; i < n; i++) it->of[which[i]] = values[i];
    return 0;
}

int fmi2GetReal(struct slider *it, const unsigned *which, size_t n, double *values) {
    it->of[F] = force(it->of);
    it->of[FRICTION_FORCE] = it->mode ? -friction(it) : -it->of[F] - it->of[F_EXT];
    for (size_t i = 0; i < n; i++) values[i] = it->of[which[i]];
    return 0;
}

int fmi2EnterEventMode(struct slider *it) { return 0; }
int fmi2EnterContinuousTimeMode(struct slider *it) { return 0; }

int fmi2NewDiscreteStates(struct slider *it, int *info) {
    double *of = it->of;
    const double along = force(of) + of[F_EXT], most = hold(of);
    for (int i = 0; i < 5; i++) info[i] = 0;
    info[0] = AGAIN;
    info[4] = BEHIND;
    ((double *)info)[3] = it->time - 1.0;
    if (it->mode && it->mode * of[X_DOT] <= 1e-11) {
        of[X_DOT] = 0.0;
        it->mode = 0;
        info[3] = !SILENT;
    }
    const double towards = along != 0.0 ? along : of[V];
    if (!it->mode && fabs(along) >= most * (1.0 - 1e-11) && (towards * of[V] > 0.0 || fabs(along) > most))
        it->mode = towards > 0.0 ? 1 : -1;
    return 0;
}

int fmi2CompletedIntegratorStep(struct slider *it, int no_set, int *event, int *end) {
    *event = STEPS && indicator(it) < 0.0;
    *end = 0;
    return 0;
}

int fmi2SetTime(struct slider *it, double time) {
    it->time = time;
    return 0;
}

int fmi2SetContinuousStates(struct slider *it, const double *x, size_t n) {
    for (int i = 0; i < 3; i++) it->of[X + i] = x[i];
    return 0;
}

int fmi2GetContinuousStates(struct slider *it, double *x, size_t n) {
    for (int i = 0; i < 3; i++) x[i] = it->of[X + i];
    return 0;
}

int fmi2GetNominalsOfContinuousStates(struct slider *it, double *x, size_t n) {
    for (int i = 0; i < 3; i++) x[i] = NOMINAL;
    return 0;
}

int fmi2GetDerivatives(struct slider *it, double *dx, size_t n) {
    const double *of = it->of;
    dx[0] = it->mode ? of[X_DOT] : CREEP;
    dx[1] = it->mode ? (force(of) + of[F_EXT] - friction(it)) / of[M] : 0.0;
    dx[2] = of[V];
    return it->time > 0.05 ? STATUS : 0;
}

int fmi2GetEventIndicators(struct slider *it, double *z, size_t n) {
    z[0] = STEPS || BLINDLY ? 1.0 : indicator(it);
    return 0;
}

/* What FMPy looks for and nobody calls. */
#define NOT_HERE(name)                                                                             \
    int fmi2##name(void *it) { return 3; }
NOT_HERE(DeSerializeFMUstate)
NOT_HERE(FreeFMUstate)
NOT_HERE(GetBoolean)
NOT_HERE(GetDirectionalDerivative)
NOT_HERE(GetFMUstate)
NOT_HERE(GetInteger)
NOT_HERE(GetString)
NOT_HERE(GetTypesPlatform)
NOT_HERE(GetVersion)
NOT_HERE(Reset)
NOT_HERE(SerializedFMUstateSize)
NOT_HERE(SerializeFMUstate)
NOT_HERE(SetBoolean)
NOT_HERE(SetDebugLogging)
NOT_HERE(SetFMUstate)
NOT_HERE(SetInteger)
NOT_HERE(SetString)
NOT_HERE(Terminate)
