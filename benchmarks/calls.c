/* Times the calls of an FMU 2.0 for co-simulation as a simulator written in C makes them.
 *
 *     calls LIBRARY GUID [NAME]
 *
 * Prints one line a measurement, or that of this name alone: name, seconds of CPU a call (the shortest of several rounds), and
 * growth of the resident memory over a further GROWTH calls in kB.
 */
#define _XOPEN_SOURCE 700

#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

enum { ROUNDS = 9, CALLS = 20000, GROWTH = 1000000, TEN = 10 };

typedef struct {
    void *logger, *allocate, *release, *step_finished, *environment;
} Callbacks;

static void *(*instantiate)(const char *, int, const char *, const char *, const Callbacks *, int,
                            int);
static void (*free_instance)(void *);
static int (*setup)(void *, int, double, double, int, double);
static int (*enter)(void *), (*leave)(void *), (*reset)(void *);
static int (*do_step)(void *, double, double, int);
static int (*get_real)(void *, const unsigned *, size_t, double *);
static int (*set_real)(void *, const unsigned *, size_t, const double *);
static int (*get_state)(void *, void **), (*set_state)(void *, void *);
static int (*free_state)(void *, void **), (*size_of)(void *, void *, size_t *);
static int (*write_out)(void *, void *, char *, size_t);
static int (*read_in)(void *, const char *, size_t, void **);

static const char *guid;
static const char *only; /* name of the one measurement, or NULL */
static const Callbacks callbacks;
static void *slave;
static int failures;

/* Value references of the table. */
enum { REF_C = 3, REF_V = 9, REF_W_PULL = 30, REF_Q_FRICTION = 32 };
static const unsigned motion[TEN] = {12, 13, 14, 15, 16, 17, 18, 23, 24, 25};
static const unsigned energies[TEN] = {12, 13, 14, 15, 16, 17, 18, 23, REF_W_PULL, REF_Q_FRICTION};
static double values[TEN];

static void step(int n) { (void)n, failures += do_step(slave, 0.0, 1e-3, 1) != 0; }
static void step_and_motion(int n)
{
    step(n);
    failures += get_real(slave, motion, TEN, values) != 0;
}
static void step_and_energies(int n)
{
    step(n);
    failures += get_real(slave, energies, TEN, values) != 0;
}
static void changed_input(int n)
{
    static const unsigned reference = REF_V;
    const double v = n % 2 ? 0.02 : 0.021;
    failures += set_real(slave, &reference, 1, &v) != 0;
    step(n);
}
static void state_round(int n)
{
    void *state = NULL;
    failures += get_state(slave, &state) != 0;
    step(n);
    failures += set_state(slave, state) != 0;
    failures += free_state(slave, &state) != 0;
}
static void bytes_round(int n)
{
    static char bytes[1 << 16];
    void *state = NULL, *again = NULL;
    size_t size = 0;
    (void)n;
    failures += get_state(slave, &state) != 0;
    failures += size_of(slave, state, &size) != 0 || size > sizeof bytes;
    failures += write_out(slave, state, bytes, size) != 0;
    failures += read_in(slave, bytes, size, &again) != 0;
    failures += set_state(slave, again) != 0;
    failures += free_state(slave, &state) != 0;
    failures += free_state(slave, &again) != 0;
}
static void instance(int n)
{
    (void)n;
    void *made = instantiate("another", 1, guid, NULL, &callbacks, 0, 0);
    failures += made == NULL;
    if (made != NULL) free_instance(made);
}
static void long_step(int n) { (void)n, failures += do_step(slave, 0.0, 1e6, 1) != 0; }

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static long resident_kB(void)
{
    long pages = 0, skipped = 0;
    FILE *file = fopen("/proc/self/statm", "r");
    if (file == NULL || fscanf(file, "%ld %ld", &skipped, &pages) != 2) pages = 0;
    if (file != NULL) fclose(file);
    return pages * (sysconf(_SC_PAGESIZE) / 1024);
}

static void start(double c)
{
    static const unsigned reference = REF_C;
    failures += reset(slave) != 0;
    failures += set_real(slave, &reference, 1, &c) != 0;
    failures += setup(slave, 0, 0.0, 0.0, 0, 0.0) != 0;
    failures += enter(slave) != 0;
    failures += leave(slave) != 0;
}

static void measure(const char *name, void (*call)(int), double c, int calls, long growth)
{
    double best = 1e300;
    if (only != NULL && strcmp(name, only) != 0) return;
    for (int round = 0; round < ROUNDS; round++) {
        start(c);
        const double begun = now();
        for (int n = 0; n < calls; n++) call(n);
        const double spent = now() - begun;
        if (spent < best) best = spent;
        if (best > 1.0) break;
    }
    const long before = resident_kB();
    for (long n = 0; n < growth; n++) call((int)n);
    printf("%s %.4g %ld\n", name, best / calls, resident_kB() - before);
    fflush(stdout);
}

static void *find(void *library, const char *name)
{
    void *found = dlsym(library, name);
    if (found == NULL) {
        fprintf(stderr, "no %s\n", name);
        exit(2);
    }
    return found;
}

int main(int count, char **arguments)
{
    const int enough = count == 3 || count == 4;
    void *library = enough ? dlopen(arguments[1], RTLD_NOW) : NULL;
    if (library == NULL) {
        fprintf(stderr, "usage: calls LIBRARY GUID [NAME] (%s)\n", enough ? dlerror() : "");
        return 2;
    }
    guid = arguments[2];
    if (count == 4) only = arguments[3];
    *(void **)&instantiate = find(library, "fmi2Instantiate");
    *(void **)&free_instance = find(library, "fmi2FreeInstance");
    *(void **)&setup = find(library, "fmi2SetupExperiment");
    *(void **)&enter = find(library, "fmi2EnterInitializationMode");
    *(void **)&leave = find(library, "fmi2ExitInitializationMode");
    *(void **)&reset = find(library, "fmi2Reset");
    *(void **)&do_step = find(library, "fmi2DoStep");
    *(void **)&get_real = find(library, "fmi2GetReal");
    *(void **)&set_real = find(library, "fmi2SetReal");
    *(void **)&get_state = find(library, "fmi2GetFMUstate");
    *(void **)&set_state = find(library, "fmi2SetFMUstate");
    *(void **)&free_state = find(library, "fmi2FreeFMUstate");
    *(void **)&size_of = find(library, "fmi2SerializedFMUstateSize");
    *(void **)&write_out = find(library, "fmi2SerializeFMUstate");
    *(void **)&read_in = find(library, "fmi2DeSerializeFMUstate");
    slave = instantiate("timed", 1, guid, NULL, &callbacks, 0, 0);
    if (slave == NULL) {
        fprintf(stderr, "no instance\n");
        return 2;
    }
    /* The first look at the memory takes some. */
    resident_kB();
    measure("step", step, 0.0, CALLS, GROWTH);
    measure("step_and_motion", step_and_motion, 0.0, CALLS, GROWTH);
    measure("step_and_energies", step_and_energies, 5.0, CALLS, GROWTH);
    measure("changed_input", changed_input, 0.0, CALLS, GROWTH);
    measure("state_round", state_round, 0.0, CALLS, GROWTH);
    measure("bytes_round", bytes_round, 0.0, CALLS, GROWTH);
    measure("instance", instance, 0.0, CALLS, GROWTH);
    measure("step_of_1e6_s", long_step, 0.0, 1, 0);
    free_instance(slave);
    return failures != 0;
}
