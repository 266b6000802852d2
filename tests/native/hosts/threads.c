/* Runs many instances of an FMU 2.0 in several threads, each through the same calls.
 *
 *     threads LIBRARY GUID THREADS INSTANCES
 *
 * Each instance is set, initialized, stepped, taken back to a state, reset and freed while others
 * do the same. Prints the number of instances whose outputs differ in a bit from those of the first
 * one, or whose calls failed: 0 where none did.
 */
#define _XOPEN_SOURCE 700

#include <dlfcn.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { OUTPUTS = 7, STEPS = 40, MOST_THREADS = 64, HELD = 50 };
static const unsigned references[OUTPUTS] = {12, 13, 15, 16, 23, 30, 32};
static const unsigned reference_v = 9, reference_load = 10;

static void *(*instantiate)(const char *, int, const char *, const char *, const void *, int, int);
static void (*release)(void *);
static int (*setup)(void *, int, double, double, int, double);
static int (*enter)(void *), (*leave)(void *), (*terminate)(void *), (*reset)(void *);
static int (*step)(void *, double, double, int);
static int (*get)(void *, const unsigned *, size_t, double *);
static int (*set)(void *, const unsigned *, size_t, const double *);
static int (*get_state)(void *, void **), (*set_state)(void *, void *);
static int (*free_state)(void *, void **);

static const char *guid;
static int per_thread;
static const void *no_callbacks[5];

/* Run the sequence; return the number of failed calls. */
static int run(void *slave, double found[OUTPUTS])
{
    int failed = setup(slave, 0, 0.0, 0.0, 0, 0.0) != 0;
    const double v = 0.05, load = 2.0;
    void *state = NULL;
    failed += set(slave, &reference_v, 1, &v) != 0;
    failed += enter(slave) != 0;
    failed += leave(slave) != 0;
    for (int n = 0; n < STEPS; n++) {
        if (n == STEPS / 2) failed += set(slave, &reference_load, 1, &load) != 0;
        failed += step(slave, 0.013 * n, 0.013, 1) != 0;
        if (n == STEPS / 4) {
            failed += get_state(slave, &state) != 0;
            failed += step(slave, 0.0, 1.7, 1) != 0;
            failed += set_state(slave, state) != 0;
            failed += free_state(slave, &state) != 0;
        }
    }
    failed += get(slave, references, OUTPUTS, found) != 0;
    return failed + (terminate(slave) != 0);
}

static double expected[OUTPUTS];

static int compared(void *slave)
{
    double found[OUTPUTS];
    const int failed = run(slave, found);
    return failed != 0 || memcmp(found, expected, sizeof found) != 0;
}

/* Hold many instances at a time, each of them run, reset and run again. */
static void *work(void *wrong)
{
    for (int made = 0; made < per_thread; made += HELD) {
        void *slaves[HELD];
        for (int n = 0; n < HELD; n++)
            slaves[n] = instantiate("one of many", 1, guid, NULL, no_callbacks, 0, 0);
        for (int n = 0; n < HELD; n++) {
            if (slaves[n] == NULL) {
                ++*(int *)wrong;
                continue;
            }
            *(int *)wrong += compared(slaves[n]);
            if (n % 5 == 0) *(int *)wrong += reset(slaves[n]) != 0 || compared(slaves[n]);
        }
        for (int n = 0; n < HELD; n++)
            if (slaves[n] != NULL) release(slaves[n]);
    }
    return NULL;
}

static void *library;

static void find(void *function, const char *name)
{
    void *found = dlsym(library, name);
    if (found == NULL) {
        fprintf(stderr, "there is no %s\n", name);
        exit(2);
    }
    memcpy(function, &found, sizeof found);
}

int main(int count, char **arguments)
{
    if (count != 5 || (library = dlopen(arguments[1], RTLD_NOW)) == NULL) {
        fprintf(stderr, "usage: threads LIBRARY GUID THREADS INSTANCES\n");
        return 2;
    }
    guid = arguments[2];
    const int threads = atoi(arguments[3]);
    if (threads < 1 || threads > MOST_THREADS) return 2;
    per_thread = atoi(arguments[4]) / threads;
    find(&instantiate, "fmi2Instantiate");
    find(&release, "fmi2FreeInstance");
    find(&setup, "fmi2SetupExperiment");
    find(&enter, "fmi2EnterInitializationMode");
    find(&leave, "fmi2ExitInitializationMode");
    find(&terminate, "fmi2Terminate");
    find(&reset, "fmi2Reset");
    find(&step, "fmi2DoStep");
    find(&get, "fmi2GetReal");
    find(&set, "fmi2SetReal");
    find(&get_state, "fmi2GetFMUstate");
    find(&set_state, "fmi2SetFMUstate");
    find(&free_state, "fmi2FreeFMUstate");
    void *first = instantiate("first", 1, guid, NULL, no_callbacks, 0, 0);
    if (first == NULL || run(first, expected) != 0) {
        fprintf(stderr, "the first instance failed\n");
        return 1;
    }
    release(first);
    pthread_t running[MOST_THREADS];
    int wrong[MOST_THREADS] = {0}, total = 0;
    for (int n = 0; n < threads; n++)
        if (pthread_create(&running[n], NULL, work, &wrong[n]) != 0) return 2;
    for (int n = 0; n < threads; n++) {
        pthread_join(running[n], NULL);
        total += wrong[n];
    }
    printf("%d\n", total);
    return total != 0;
}
