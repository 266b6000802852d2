/* A foreign FMU 2.0 for co-simulation in C99: the stick-slip block by closed forms.
 *
 * Slip: with r = u - v (velocity relative to the pulled end) and a = du/dt,
 *   r'' + 2 alpha r' + w^2 r = 0,   alpha = c/(2 m),   w^2 = k/m,
 * k times the integral of r is -m (a - a0) - c (r - r0).
 * FAULT is 0, or the number of a planted fault.
 */
#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#ifndef FAULT
#define FAULT 0
#endif
#define NOTHING_TOGETHER 1 /* load and F_ext changed together in a slip: F_ext stays as it was */
#define RESET_KEEPS_MASS 2 /* after a reset the coefficients are still those of the old mass */

#define EXPORT __attribute__((visibility("default")))

typedef void *Component;
typedef unsigned Reference;
typedef enum { OK, WARNING, DISCARD, ERROR, FATAL, PENDING } Status;

/* Value references of the Reals: what is given, then what is shown. */
enum { MASS, GRAVITY, X0, U0, Z0, STIFFNESS, DAMPING, MU_S, MU_K, PULL, LOAD, PUSH, GIVEN };
enum { X = GIVEN, U, X_PULL, Z, SPRING, FRICTION, EVENT, REALS };

static const double DEFAULTS[GIVEN] = {1.0, 9.81, 0.0, 0.0, 0.0, 1000.0,
                                       0.0, 0.5,  0.3, 0.02, 0.0, 0.0};
static const double PI = 3.14159265358979323846;
static const double EPSILON = 2.2204460492503131e-16;

typedef struct {
    double given[GIVEN]; /* as set */
    double p[GIVEN];     /* in force */
    double x, u, z;      /* at the beginning of the arc, but shown as they are now */
    double shown_x, shown_u, shown_z;
    double r0, a0;       /* of a slip */
    double age, end;     /* of the arc */
    double event, start;
    double w_square, alpha;
    int touches;
    int mode;
    int count;
    int running;
    int coefficients;
} Block;

static double normal(const Block *b) {
    const double force = b->p[MASS] * b->p[GRAVITY] + b->p[LOAD];
    return force > 4.0 * EPSILON * b->p[MASS] * b->p[GRAVITY] ? force : 0.0;
}

static double mu_k(const Block *b) {
    if (b->p[MU_K] <= b->p[MU_S]) return b->p[MU_K];
    return b->p[MU_S] > 0.01 ? b->p[MU_S] - 0.01 : 0.0;
}

static double driving(const Block *b) { return b->p[STIFFNESS] * b->z + b->p[PUSH]; }

static int loose(const Block *b) {
    const double limit = b->p[MU_S] * normal(b), force = driving(b);
    const double size = fabs(b->p[STIFFNESS] * b->z) + fabs(b->p[PUSH]) + limit;
    if (fabs(force) - limit <= 8.0 * EPSILON * size) return 0;
    return force > 0.0 ? 1 : -1;
}

/* exp(-alpha t) cos(nu t) and exp(-alpha t) sin(nu t)/nu, nu^2 = w^2 - alpha^2 of either sign. */
static void responses(const Block *b, double t, double *even, double *odd) {
    const double w = sqrt(b->w_square), difference = (w - b->alpha) * (w + b->alpha);
    if (difference > 0.0) {
        const double nu = sqrt(difference), fade = exp(-b->alpha * t);
        *even = fade * cos(nu * t);
        *odd = fade * sin(nu * t) / nu;
    } else {
        const double nu = sqrt(-difference);
        const double slow = exp(-t * b->w_square / (b->alpha + nu)), fast = expm1(-2.0 * nu * t);
        *even = slow * (1.0 + 0.5 * fast);
        *odd = slow * (nu > 0.0 ? -0.5 * fast / nu : t);
    }
}

static double relative(const Block *b, double t) {
    double even, odd;
    responses(b, t, &even, &odd);
    return b->r0 * even + (b->a0 + b->alpha * b->r0) * odd;
}

static double acceleration(const Block *b, double t) {
    double even, odd;
    responses(b, t, &even, &odd);
    return b->a0 * even - (b->alpha * b->a0 + b->w_square * b->r0) * odd;
}

/* Velocity along the slip. */
static double along(const Block *b, double t) { return b->mode * (b->p[PULL] + relative(b, t)); }

/* Zero of a velocity that falls from >= 0 to <= 0 between two times. */
static double crossing(const Block *b, double low, double high) {
    double t = high;
    for (int n = 0; n < 200; n++) {
        const double value = along(b, t), slope = b->mode * acceleration(b, t);
        double next;
        if (value > 0.0) low = t; else high = t;
        next = slope < 0.0 ? t - value / slope : low;
        if (!(next > low && next < high)) next = 0.5 * (low + high);
        if (fabs(next - t) <= EPSILON * t) return next;
        t = next;
    }
    return t;
}

/* Time at which the slip ends; infinite if it has no end. */
static double stop_of(Block *b) {
    const double w = sqrt(b->w_square), difference = (w - b->alpha) * (w + b->alpha);
    const double across = b->alpha * b->a0 + b->w_square * b->r0;
    const double V = b->mode * b->p[PULL], start = b->mode * b->a0;
    double top = 0.0, bottom = INFINITY;
    b->touches = 0;
    if (difference > 0.0) {
        /* b->mode a ~ cos(nu t + phase); it crosses zero upward at a phase of -pi/2. */
        const double nu = sqrt(difference);
        const double phase = atan2(b->mode * across / nu, start);
        bottom = 1.5 * PI - phase;
        if (bottom > 2.0 * PI) bottom -= 2.0 * PI;
        top = bottom > PI ? (bottom - PI) / nu : 0.0;
        bottom /= nu;
    } else {
        const double nu = sqrt(-difference);
        const double part = across != 0.0 ? b->a0 / across : INFINITY;
        double turn = INFINITY;
        if (nu == 0.0 && part > 0.0) turn = part;
        if (nu > 0.0 && part > 0.0 && part * nu < 1.0) turn = atanh(part * nu) / nu;
        if (start > 0.0 && turn < INFINITY) top = turn;
        if (start < 0.0) bottom = turn;
        if (start >= 0.0 && top == 0.0) return INFINITY;
    }
    if (bottom < INFINITY) {
        const double lowest = along(b, bottom);
        const double size = fabs(V) + fabs(b->r0) + fabs(b->a0) / w;
        if (fabs(lowest) <= 16.0 * EPSILON * size) {
            b->touches = 1;
            return bottom;
        }
        return lowest > 0.0 ? INFINITY : crossing(b, top, bottom);
    }
    if (V >= 0.0) return INFINITY;
    bottom = top + 1.0 / w;
    while (along(b, bottom) > 0.0) {
        top = bottom;
        bottom *= 2.0;
    }
    return crossing(b, top, bottom);
}

/* Begin an arc at the present state; net is the net force of a slip. */
static void begin(Block *b, double net) {
    if (!(FAULT == RESET_KEEPS_MASS && b->coefficients)) {
        b->w_square = b->p[STIFFNESS] / b->p[MASS];
        b->alpha = 0.5 * b->p[DAMPING] / b->p[MASS];
    }
    b->age = 0.0;
    if (b->mode) {
        b->r0 = b->u - b->p[PULL];
        b->a0 = (net - b->p[DAMPING] * b->u) * b->w_square / b->p[STIFFNESS];
        b->end = stop_of(b);
    } else if (loose(b)) {
        b->end = 0.0;
    } else if (b->p[PULL] == 0.0) {
        b->end = INFINITY;
    } else {
        const double limit = copysign(b->p[MU_S] * normal(b), b->p[PULL]);
        b->end = fmax((limit - driving(b)) / (b->p[STIFFNESS] * b->p[PULL]), 0.0);
    }
}

static double net_force(const Block *b) { return driving(b) - b->mode * mu_k(b) * normal(b); }

/* Show the state at the present age of the arc. */
static void show(Block *b) {
    const double v = b->p[PULL], t = b->age;
    if (b->mode) {
        const double r = relative(b, t), a = acceleration(b, t);
        const double grown =
            ((a - b->a0) / b->w_square + b->p[DAMPING] / b->p[STIFFNESS] * (r - b->r0));
        b->shown_u = v + r;
        b->shown_z = b->z + grown;
        b->shown_x = b->x + (v * t - grown);
    } else {
        b->shown_u = 0.0;
        b->shown_z = b->z + v * t;
        b->shown_x = b->x;
    }
}

/* Let the arc begin anew at the state that is shown. */
static void rebase(Block *b) {
    show(b);
    b->x = b->shown_x;
    b->u = b->shown_u;
    b->z = b->shown_z;
}

static void transition(Block *b) {
    b->age = b->end;
    rebase(b);
    if (b->mode) {
        int back;
        b->count++;
        b->u = 0.0;
        if (b->touches) b->z = (b->mode * mu_k(b) * normal(b) - b->p[PUSH]) / b->p[STIFFNESS];
        back = loose(b);
        b->mode = back;
        begin(b, net_force(b));
    } else {
        const int beyond = loose(b);
        if (beyond) {
            b->mode = beyond;
            begin(b, net_force(b));
        } else {
            b->mode = b->p[PULL] > 0.0 ? 1 : -1;
            b->z = (b->mode * b->p[MU_S] * normal(b) - b->p[PUSH]) / b->p[STIFFNESS];
            begin(b, b->mode * (b->p[MU_S] - mu_k(b)) * normal(b));
        }
    }
    show(b);
}

static void advance(Block *b, double now, double h) {
    double left = h;
    for (;;) {
        const double rest = fmax(b->end - b->age, 0.0);
        /* At the end of a step a stop has happened, a break-away has not. */
        if (b->mode ? rest > left : rest >= left) break;
        left -= rest;
        b->event = now + (h - left);
        transition(b);
        if (left == 0.0) return;
    }
    b->age += left;
    show(b);
}

static int sound(const double *given, double h) {
    for (int n = 0; n < GIVEN; n++)
        if (!isfinite(given[n])) return 0;
    return isfinite(h) && h > 0.0 && given[MASS] > 0.0 && given[STIFFNESS] > 0.0;
}

/* Put in force what was set since the last step. */
static void take(Block *b) {
    int differs = 0;
    const int together = b->given[LOAD] != b->p[LOAD] && b->given[PUSH] != b->p[PUSH];
    for (int n = STIFFNESS; n < GIVEN; n++) {
        if (FAULT == NOTHING_TOGETHER && n == PUSH && together && b->mode) continue;
        differs |= b->given[n] != b->p[n];
    }
    if (!differs) return;
    rebase(b);
    for (int n = STIFFNESS; n < GIVEN; n++) {
        if (FAULT == NOTHING_TOGETHER && n == PUSH && together && b->mode) {
            b->given[n] = b->p[n];
            continue;
        }
        b->p[n] = b->given[n];
    }
    b->coefficients = 0;
    begin(b, net_force(b));
}

EXPORT const char *fmi2GetTypesPlatform(void) { return "default"; }

EXPORT const char *fmi2GetVersion(void) { return "2.0"; }

EXPORT Status fmi2SetDebugLogging(Component c, int on, size_t n, const char *const categories[]) {
    (void)c, (void)on, (void)n, (void)categories;
    return OK;
}

EXPORT Component fmi2Instantiate(const char *name, int type, const char *guid, const char *where,
                                 const void *callbacks, int visible, int logging) {
    Block *b = calloc(1, sizeof *b);
    (void)name, (void)guid, (void)where, (void)callbacks, (void)visible, (void)logging;
    if (b == NULL || type != 1) {
        free(b);
        return NULL;
    }
    memcpy(b->given, DEFAULTS, sizeof DEFAULTS);
    return b;
}

EXPORT void fmi2FreeInstance(Component c) { free(c); }

EXPORT Status fmi2SetupExperiment(Component c, int tolerant, double tolerance, double start,
                                  int stops, double stop) {
    (void)tolerant, (void)tolerance, (void)stops, (void)stop;
    ((Block *)c)->start = start;
    return OK;
}

EXPORT Status fmi2EnterInitializationMode(Component c) {
    (void)c;
    return OK;
}

EXPORT Status fmi2ExitInitializationMode(Component c) {
    Block *b = c;
    if (!sound(b->given, 1.0)) return ERROR;
    memcpy(b->p, b->given, sizeof b->p);
    b->x = b->p[X0];
    b->u = b->p[U0];
    b->z = b->p[Z0];
    b->mode = (b->u > 0.0) - (b->u < 0.0);
    b->event = b->start;
    b->running = 1;
    begin(b, net_force(b));
    show(b);
    b->coefficients = 1;
    return OK;
}

EXPORT Status fmi2Terminate(Component c) {
    (void)c;
    return OK;
}

EXPORT Status fmi2Reset(Component c) {
    Block *b = c;
    const Block old = *b;
    memset(b, 0, sizeof *b);
    memcpy(b->given, DEFAULTS, sizeof DEFAULTS);
    if (FAULT == RESET_KEEPS_MASS) {
        b->coefficients = old.running;
        b->w_square = old.w_square;
        b->alpha = old.alpha;
    }
    return OK;
}

static int shown_mode(const Block *b) {
    if (!b->running) return 0;
    return b->mode || b->age > 0.0 ? b->mode : loose(b);
}

static double shown(const Block *b, Reference which) {
    const int mode = shown_mode(b);
    const double force = b->p[STIFFNESS] * b->shown_z;
    switch (which) {
    case X: return b->shown_x;
    case U: return b->shown_u;
    case X_PULL: return b->shown_x + b->shown_z;
    case Z: return b->shown_z;
    case SPRING: return force;
    case EVENT: return b->event;
    default:
        if (mode == 0) return -(force + b->p[PUSH]);
        return -(mode * mu_k(b) * normal(b) + b->p[DAMPING] * b->shown_u);
    }
}

EXPORT Status fmi2GetReal(Component c, const Reference which[], size_t n, double values[]) {
    for (size_t i = 0; i < n; i++) {
        if (which[i] >= REALS) return ERROR;
        values[i] = which[i] < GIVEN ? ((Block *)c)->given[which[i]] : shown(c, which[i]);
    }
    return OK;
}

EXPORT Status fmi2SetReal(Component c, const Reference which[], size_t n, const double values[]) {
    for (size_t i = 0; i < n; i++) {
        if (which[i] >= GIVEN) return ERROR;
        ((Block *)c)->given[which[i]] = values[i];
    }
    return OK;
}

EXPORT Status fmi2GetInteger(Component c, const Reference which[], size_t n, int values[]) {
    for (size_t i = 0; i < n; i++) {
        if (which[i] > 1) return ERROR;
        values[i] = which[i] == 0 ? shown_mode(c) : ((Block *)c)->count;
    }
    return OK;
}

EXPORT Status fmi2GetBoolean(Component c, const Reference which[], size_t n, int values[]) {
    for (size_t i = 0; i < n; i++) {
        if (which[i] > 0) return ERROR;
        values[i] = shown_mode(c) == 0;
    }
    return OK;
}

EXPORT Status fmi2GetFMUstate(Component c, void **state) {
    if (*state == NULL) *state = malloc(sizeof(Block));
    if (*state == NULL) return ERROR;
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
    if (size < sizeof(Block)) return ERROR;
    memcpy(bytes, state, sizeof(Block));
    return OK;
}

EXPORT Status fmi2DeSerializeFMUstate(Component c, const char bytes[], size_t size, void **state) {
    (void)c;
    if (size != sizeof(Block)) return ERROR;
    *state = malloc(sizeof(Block));
    if (*state == NULL) return ERROR;
    memcpy(*state, bytes, sizeof(Block));
    return OK;
}

EXPORT Status fmi2DoStep(Component c, double now, double h, int no_set_before) {
    Block *b = c;
    (void)no_set_before;
    if (!sound(b->given, h)) return DISCARD;
    take(b);
    advance(b, now, h);
    return OK;
}

/* What the description does not offer. */
#define ABSENT(name) \
    EXPORT Status name(void) { return ERROR; }
ABSENT(fmi2SetInteger)
ABSENT(fmi2SetBoolean)
ABSENT(fmi2GetString)
ABSENT(fmi2SetString)
ABSENT(fmi2GetDirectionalDerivative)
ABSENT(fmi2SetRealInputDerivatives)
ABSENT(fmi2GetRealOutputDerivatives)
ABSENT(fmi2CancelStep)
ABSENT(fmi2GetStatus)
ABSENT(fmi2GetRealStatus)
ABSENT(fmi2GetIntegerStatus)
ABSENT(fmi2GetBooleanStatus)
ABSENT(fmi2GetStringStatus)
