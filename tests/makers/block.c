/* A foreign FMU 2.0 for co-simulation in C99: the stick-slip block by power series.
 *
 * Of the net force e = k z + F_ext - s mu_k N and the velocity u: e' = k (v - u), m u' = e - c u.
 * FAULT is "" or names a planted fault:
 *   push lost beside load: load and F_ext changed together in a slip, F_ext stays as it was
 *   reset keeps mass: after a reset the mass is still the old one
 */
#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#define EXPORT __attribute__((visibility("default")))
#define HAS(fault) (strcmp(FAULT, fault) == 0)
#define ORDER 22
#define STEP 1.0       /* of a series, in units of 1/max(w, c/m) */
#define ROUNDING 2e-15 /* part of the forces that does not count */

typedef void *Component;
typedef unsigned Reference;
typedef enum { OK, WARNING, DISCARD, ERROR } Status;

/* Value references of the Reals: what is given, then what is shown. */
enum { M, G, K, C, MU_S, MU_K, X0, U0, Z0, V, LOAD, PUSH, GIVEN };
enum { X = GIVEN, U, X_PULL, Z, SPRING, FRICTION, EVENT, REALS };

static const double DEFAULTS[GIVEN] = {1, 9.81, 1000, 0, 0.5, 0.3, 0, 0, 0, 0.02, 0, 0};

typedef struct {
    double given[GIVEN], p[GIVEN]; /* as set, and in force */
    double x, u, z, e, event, start;
    int mode, count, running;
} Block;

static double normal(const Block *b) {
    const double weight = b->p[M] * b->p[G], force = weight + b->p[LOAD];
    return force > ROUNDING * weight ? force : 0.0;
}

static double mu_k(const Block *b) {
    if (b->p[MU_K] <= b->p[MU_S]) return b->p[MU_K];
    return fmax(b->p[MU_S] - 0.01, 0.0);
}

static double driving(const Block *b) { return b->p[K] * b->z + b->p[PUSH]; }

/* Where a mass at rest is driven at once; 0 if friction holds it. */
static int loose(const Block *b) {
    const double limit = b->p[MU_S] * normal(b), force = driving(b);
    const double size = fabs(b->p[K] * b->z) + fabs(b->p[PUSH]) + limit;
    if (fabs(force) - limit <= ROUNDING * size) return 0;
    return force > 0.0 ? 1 : -1;
}

static double net_force(const Block *b) { return driving(b) - b->mode * mu_k(b) * normal(b); }

/* Velocity along the slip after t, and in what the net force and the velocity end. */
static double along(const Block *b, double t, double *e, double *u) {
    double of_e = b->e, of_u = b->u, v = b->p[V];
    *e = of_e;
    *u = of_u;
    for (int n = 1; n <= ORDER; n++) {
        const double next = t / n * b->p[K] * (v - of_u);
        of_u = t / n * (of_e - b->p[C] * of_u) / b->p[M];
        of_e = next;
        v = 0.0;
        *e += of_e;
        *u += of_u;
    }
    return b->mode * *u;
}

/* Push along the slip after t. */
static double push(const Block *b, double t) {
    double e, u;
    along(b, t, &e, &u);
    return b->mode * (e - b->p[C] * u);
}

/* Zero between two times of the velocity, or of the push, that changes its sign there once. */
static double zero(const Block *b, int of_push, double low, double high) {
    double e, u;
    const int after = (of_push ? push(b, high) : along(b, high, &e, &u)) > 0.0;
    for (int n = 0; n < 80; n++) {
        const double middle = 0.5 * (low + high);
        const double value = of_push ? push(b, middle) : along(b, middle, &e, &u);
        if ((value > 0.0) == after) high = middle; else low = middle;
    }
    return high;
}

/* Slip on for at most left, by one series; return for how long. */
static double slip(Block *b, double end, double left) {
    const double w = sqrt(b->p[K] / b->p[M]);
    double h = fmin(left, STEP / fmax(w, b->p[C] / b->p[M])), low = 0.0, e, u;
    const double size = fabs(b->p[V]) + fabs(b->u) + fabs(b->e) * w / b->p[K];
    const double before = push(b, 0.0), after = push(b, h);
    int stops = 0, touches = 0;
    if (before > 0.0 ? after <= 0.0 : before < 0.0 && after >= 0.0) {
        const double turn = zero(b, 1, 0.0, h), speed = along(b, turn, &e, &u);
        if (before > 0.0) {
            low = turn;
        } else if (speed <= ROUNDING * size) {
            touches = speed >= -ROUNDING * size;
            h = touches ? turn : zero(b, 0, 0.0, turn);
            stops = 1;
        }
    }
    if (!stops && along(b, h, &e, &u) <= 0.0) {
        h = zero(b, 0, low, h);
        stops = 1;
    }
    along(b, h, &e, &u);
    const double grown = (e - b->e) / b->p[K];
    b->z += grown;
    b->x += b->p[V] * h - grown;
    b->e = e;
    b->u = u;
    if (stops) {
        if (touches) b->z = (b->mode * mu_k(b) * normal(b) - b->p[PUSH]) / b->p[K];
        b->u = 0.0;
        b->count++;
        b->event = end - (left - h);
        b->mode = loose(b);
        b->e = net_force(b);
    }
    return h;
}

/* Rest for at most left; return for how long. */
static double stick(Block *b, double end, double left) {
    const double v = b->p[V], limit = copysign(b->p[MU_S] * normal(b), v);
    double wait = INFINITY;
    b->mode = loose(b);
    if (b->mode) {
        b->event = end - left;
        b->e = net_force(b);
        return 0.0;
    }
    if (v != 0.0) wait = fmax((limit - driving(b)) / (b->p[K] * v), 0.0);
    if (wait >= left) {
        b->z += v * left;
        return left;
    }
    b->mode = v > 0.0 ? 1 : -1;
    b->z = (limit - b->p[PUSH]) / b->p[K];
    b->e = limit - b->mode * mu_k(b) * normal(b);
    b->event = end - (left - wait);
    return wait;
}

static int sound(const double *given, double h) {
    for (int n = 0; n < GIVEN; n++)
        if (!isfinite(given[n])) return 0;
    return isfinite(h) && h > 0.0 && given[M] > 0.0 && given[K] > 0.0;
}

EXPORT Component fmi2Instantiate(const char *name, int type, const char *guid, const char *where,
                                 const void *callbacks, int visible, int logging) {
    Block *b = calloc(1, sizeof *b);
    (void)name, (void)type, (void)guid, (void)where, (void)callbacks, (void)visible, (void)logging;
    if (b != NULL) memcpy(b->given, DEFAULTS, sizeof DEFAULTS);
    return b;
}

EXPORT void fmi2FreeInstance(Component c) { free(c); }

EXPORT Status fmi2SetupExperiment(Component c, int tolerant, double tolerance, double start,
                                  int stops, double stop) {
    (void)tolerant, (void)tolerance, (void)stops, (void)stop;
    ((Block *)c)->start = start;
    return OK;
}

EXPORT Status fmi2ExitInitializationMode(Component c) {
    Block *b = c;
    const double mass = b->p[M];
    if (!sound(b->given, 1.0)) return ERROR;
    memcpy(b->p, b->given, sizeof b->p);
    if (HAS("reset keeps mass") && mass > 0.0) b->p[M] = mass;
    b->x = b->p[X0];
    b->u = b->p[U0];
    b->z = b->p[Z0];
    b->mode = (b->u > 0.0) - (b->u < 0.0);
    b->e = net_force(b);
    b->event = b->start;
    b->running = 1;
    return OK;
}

EXPORT Status fmi2Reset(Component c) {
    Block *b = c;
    const double mass = b->p[M];
    memset(b, 0, sizeof *b);
    memcpy(b->given, DEFAULTS, sizeof DEFAULTS);
    b->p[M] = HAS("reset keeps mass") ? mass : 0.0;
    return OK;
}

EXPORT Status fmi2DoStep(Component c, double now, double h, int no_set_before) {
    Block *b = c;
    const int lost = HAS("push lost beside load") && b->mode && b->given[LOAD] != b->p[LOAD];
    double left = h;
    (void)no_set_before;
    if (!sound(b->given, h)) return DISCARD;
    if (lost) b->given[PUSH] = b->p[PUSH];
    if (memcmp(b->given + K, b->p + K, sizeof b->p - K * sizeof *b->p) != 0) {
        memcpy(b->p + K, b->given + K, sizeof b->p - K * sizeof *b->p);
        if (b->mode) b->e = net_force(b);
    }
    while (left > 0.0) left -= b->mode ? slip(b, now + h, left) : stick(b, now + h, left);
    return OK;
}

static int shown_mode(const Block *b) { return !b->running || b->mode ? b->mode : loose(b); }

static double shown(const Block *b, Reference which) {
    const int mode = shown_mode(b);
    switch (which) {
    case X: return b->x;
    case U: return b->u;
    case X_PULL: return b->x + b->z;
    case Z: return b->z;
    case SPRING: return b->p[K] * b->z;
    case EVENT: return b->event;
    default: return mode ? -(mode * mu_k(b) * normal(b) + b->p[C] * b->u) : -driving(b);
    }
}

EXPORT Status fmi2GetReal(Component c, const Reference which[], size_t n, double values[]) {
    for (size_t i = 0; i < n; i++)
        values[i] = which[i] < GIVEN ? ((Block *)c)->given[which[i]] : shown(c, which[i]);
    return OK;
}

EXPORT Status fmi2SetReal(Component c, const Reference which[], size_t n, const double values[]) {
    for (size_t i = 0; i < n; i++) ((Block *)c)->given[which[i]] = values[i];
    return OK;
}

EXPORT Status fmi2GetInteger(Component c, const Reference which[], size_t n, int values[]) {
    for (size_t i = 0; i < n; i++) values[i] = which[i] ? ((Block *)c)->count : shown_mode(c);
    return OK;
}

EXPORT Status fmi2GetBoolean(Component c, const Reference which[], size_t n, int values[]) {
    for (size_t i = 0; i < n; i++) values[i] = which[i] == 0 && shown_mode(c) == 0;
    return OK;
}

EXPORT Status fmi2GetFMUstate(Component c, void **state) {
    if (*state == NULL) *state = malloc(sizeof(Block));
    memcpy(*state, c, sizeof(Block));
    return OK;
}

EXPORT Status fmi2SetFMUstate(Component c, void *state) {
    memcpy(c, state, sizeof(Block));
    return OK;
}

EXPORT Status fmi2FreeFMUstate(Component c, void **state) {
    (void)c;
    free(*state);
    *state = NULL;
    return OK;
}

EXPORT Status fmi2SerializedFMUstateSize(Component c, void *state, size_t *size) {
    (void)c, (void)state;
    *size = sizeof(Block);
    return OK;
}

EXPORT Status fmi2SerializeFMUstate(Component c, void *state, char bytes[], size_t size) {
    (void)c;
    memcpy(bytes, state, size);
    return OK;
}

EXPORT Status fmi2DeSerializeFMUstate(Component c, const char bytes[], size_t size, void **state) {
    (void)c;
    *state = malloc(sizeof(Block));
    memcpy(*state, bytes, size);
    return OK;
}

/* What does nothing here, and what the description does not offer. */
#define ANSWERS(name, status) \
    EXPORT Status name(void) { return status; }
ANSWERS(fmi2SetDebugLogging, OK)
ANSWERS(fmi2EnterInitializationMode, OK)
ANSWERS(fmi2Terminate, OK)
ANSWERS(fmi2GetTypesPlatform, ERROR)
ANSWERS(fmi2GetVersion, ERROR)
ANSWERS(fmi2SetInteger, ERROR)
ANSWERS(fmi2SetBoolean, ERROR)
ANSWERS(fmi2GetString, ERROR)
ANSWERS(fmi2SetString, ERROR)
ANSWERS(fmi2GetDirectionalDerivative, ERROR)
ANSWERS(fmi2SetRealInputDerivatives, ERROR)
ANSWERS(fmi2GetRealOutputDerivatives, ERROR)
ANSWERS(fmi2CancelStep, ERROR)
ANSWERS(fmi2GetStatus, ERROR)
ANSWERS(fmi2GetRealStatus, ERROR)
ANSWERS(fmi2GetIntegerStatus, ERROR)
ANSWERS(fmi2GetBooleanStatus, ERROR)
ANSWERS(fmi2GetStringStatus, ERROR)
