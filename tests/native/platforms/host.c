/* Runs calls of FMI 2.0 in the library of an FMU, on any platform.
 *
 *     host LIBRARY GUID < calls
 *
 * Each line of standard input is a call; the answer is a line of standard output, the number of the
 * status, then what was read. The messages of the FMU come as lines of their own before it. Numbers
 * are hexadecimal, so that no digit is lost.
 *
 *     setup T, enter, exit, terminate, reset
 *     step T H                  a communication step of H [s] from T [s]
 *     set REFERENCE VALUE ...   real variables
 *     real, integer, boolean REFERENCE ...
 *     save, restore             the state is kept in memory, and taken up
 *     write, read BYTES         the state as bytes, each two hexadecimal digits
 *
 * The exit code is 2 where the library or a line of the input cannot be used.
 */
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#ifdef _WIN32
#include <windows.h>
static void (*function_in(const char *path, const char *name))(void)
{
    HMODULE library = LoadLibraryA(path);
    return library == NULL ? NULL : (void (*)(void))GetProcAddress(library, name);
}
#else
#include <dlfcn.h>
static void (*function_in(const char *path, const char *name))(void)
{
    void *library = dlopen(path, RTLD_NOW | RTLD_LOCAL);
    void (*found)(void) = NULL;
    void *address = library == NULL ? NULL : dlsym(library, name);
    memcpy(&found, &address, sizeof found);
    return found;
}
#endif

enum { MOST = 64, LONGEST = 1 << 16 };

typedef void Logger(void *, const char *, int, const char *, const char *, ...);

static struct {
    Logger *logger;
    void *(*allocate)(size_t, size_t);
    void (*release)(void *);
    void (*step_finished)(void *, int);
    void *environment;
} callbacks;

static void *(*instantiate)(const char *, int, const char *, const char *, const void *, int, int);
static void (*free_instance)(void *);
static int (*setup)(void *, int, double, double, int, double);
static int (*enter)(void *), (*leave)(void *), (*terminate)(void *), (*reset)(void *);
static int (*step)(void *, double, double, int);
static int (*get_real)(void *, const unsigned *, size_t, double *);
static int (*get_integer)(void *, const unsigned *, size_t, int *);
static int (*get_boolean)(void *, const unsigned *, size_t, int *);
static int (*set_real)(void *, const unsigned *, size_t, const double *);
static int (*get_state)(void *, void **), (*set_state)(void *, void *);
static int (*free_state)(void *, void **), (*size_of)(void *, void *, size_t *);
static int (*write_state)(void *, void *, char *, size_t);
static int (*read_state)(void *, const char *, size_t, void **);

static const struct {
    const char *name;
    void *slot;
} FUNCTIONS[] = {
    {"fmi2Instantiate", &instantiate},
    {"fmi2FreeInstance", &free_instance},
    {"fmi2SetupExperiment", &setup},
    {"fmi2EnterInitializationMode", &enter},
    {"fmi2ExitInitializationMode", &leave},
    {"fmi2Terminate", &terminate},
    {"fmi2Reset", &reset},
    {"fmi2DoStep", &step},
    {"fmi2GetReal", &get_real},
    {"fmi2GetInteger", &get_integer},
    {"fmi2GetBoolean", &get_boolean},
    {"fmi2SetReal", &set_real},
    {"fmi2GetFMUstate", &get_state},
    {"fmi2SetFMUstate", &set_state},
    {"fmi2FreeFMUstate", &free_state},
    {"fmi2SerializedFMUstateSize", &size_of},
    {"fmi2SerializeFMUstate", &write_state},
    {"fmi2DeSerializeFMUstate", &read_state},
};

static void fail(const char *cause, const char *which)
{
    fprintf(stderr, "host: %s: %s\n", cause, which);
    exit(2);
}

/* The text is a printf format, as FMI has it. */
static void show(void *environment, const char *instance, int status, const char *category,
                 const char *format, ...)
{
    va_list arguments;
    (void)environment;
    printf("%s %d %s: ", instance, status, category);
    va_start(arguments, format);
    vprintf(format, arguments);
    va_end(arguments);
    putchar('\n');
}

/* The next word of the line, NULL at its end. */
static char *word(void)
{
    return strtok(NULL, " \r\n");
}

static double number(void)
{
    const char *text = word();
    if (text == NULL) fail("a number is missing", "");
    return strtod(text, NULL);
}

/* The references in the rest of the line, and behind each its value where `values` is not NULL. */
static size_t list(unsigned references[MOST], double *values)
{
    size_t count = 0;
    for (const char *text = word(); text != NULL; text = word()) {
        if (count == MOST) fail("too many variables", text);
        references[count] = (unsigned)strtoul(text, NULL, 10);
        if (values != NULL) values[count] = number();
        count++;
    }
    return count;
}

static void print_integers(int status, const int values[], size_t count)
{
    printf("%d", status);
    for (size_t n = 0; n < count && status == 0; n++) printf(" %d", values[n]);
    putchar('\n');
}

static void print_reals(int status, const double values[], size_t count)
{
    printf("%d", status);
    for (size_t n = 0; n < count && status == 0; n++) printf(" %a", values[n]);
    putchar('\n');
}

static void print_bytes(void *slave)
{
    static char bytes[LONGEST];
    void *state = NULL;
    size_t size = 0;
    int status = get_state(slave, &state);
    if (status == 0) status = size_of(slave, state, &size);
    if (size > sizeof bytes) fail("a state is too long", "");
    if (status == 0) status = write_state(slave, state, bytes, size);
    printf("%d ", status);
    for (size_t n = 0; n < size && status == 0; n++) printf("%02x", (unsigned char)bytes[n]);
    putchar('\n');
    free_state(slave, &state);
}

static int read_bytes(void *slave)
{
    static char bytes[LONGEST];
    const char *text = word();
    void *state = NULL;
    size_t size = 0;
    if (text == NULL) fail("the bytes are missing", "");
    for (unsigned byte; size < sizeof bytes && sscanf(text, "%2x", &byte) == 1; text += 2)
        bytes[size++] = (char)byte;
    int status = read_state(slave, bytes, size, &state);
    if (status == 0) status = set_state(slave, state);
    if (state != NULL) free_state(slave, &state);
    return status;
}

/* Carry out one line, and print the answer. */
static void answer(void *slave, const char *call)
{
    static void *state;
    unsigned references[MOST];
    double values[MOST];
    int integers[MOST], status = 0;
    if (strcmp(call, "real") == 0) {
        const size_t count = list(references, NULL);
        status = get_real(slave, references, count, values);
        print_reals(status, values, count);
        return;
    }
    if (strcmp(call, "integer") == 0 || strcmp(call, "boolean") == 0) {
        const size_t count = list(references, NULL);
        status = (*call == 'i' ? get_integer : get_boolean)(slave, references, count, integers);
        print_integers(status, integers, count);
        return;
    }
    if (strcmp(call, "write") == 0) {
        print_bytes(slave);
        return;
    }
    if (strcmp(call, "set") == 0) {
        const size_t count = list(references, values);
        status = set_real(slave, references, count, values);
    } else if (strcmp(call, "step") == 0) {
        const double time = number();
        status = step(slave, time, number(), 0);
    } else if (strcmp(call, "setup") == 0) {
        status = setup(slave, 0, 0.0, number(), 0, 0.0);
    } else if (strcmp(call, "enter") == 0) {
        status = enter(slave);
    } else if (strcmp(call, "exit") == 0) {
        status = leave(slave);
    } else if (strcmp(call, "terminate") == 0) {
        status = terminate(slave);
    } else if (strcmp(call, "reset") == 0) {
        status = reset(slave);
    } else if (strcmp(call, "save") == 0) {
        status = get_state(slave, &state);
    } else if (strcmp(call, "restore") == 0) {
        status = set_state(slave, state);
    } else if (strcmp(call, "read") == 0) {
        status = read_bytes(slave);
    } else {
        fail("no such call", call);
    }
    print_integers(status, NULL, 0);
}

int main(int count, char **arguments)
{
    static char line[2 * LONGEST];
    if (count != 3) fail("use", "host LIBRARY GUID < calls");
    for (size_t n = 0; n < sizeof FUNCTIONS / sizeof *FUNCTIONS; n++) {
        void (*found)(void) = function_in(arguments[1], FUNCTIONS[n].name);
        if (found == NULL) fail("the library cannot be loaded, or lacks", FUNCTIONS[n].name);
        memcpy(FUNCTIONS[n].slot, &found, sizeof found);
    }
    callbacks.logger = show;
    void *slave = instantiate("block", 1, arguments[2], NULL, &callbacks, 0, 1);
    if (slave == NULL) fail("no instance with GUID", arguments[2]);
    while (fgets(line, sizeof line, stdin) != NULL) {
        const char *call = strtok(line, " \r\n");
        if (call != NULL) answer(slave, call);
    }
    free_instance(slave);
    return 0;
}
