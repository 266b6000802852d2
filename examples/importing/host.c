/* Runs an FMU 2.0 for co-simulation the way a simulator written in C does.
 *
 *     cc -std=c99 -o host host.c -ldl
 *     unzip -q -d stickslip StickSlip.fmu
 *     LD_PRELOAD=libpython3.11.so.1.0 ./host stickslip > run.csv
 *     LD_PRELOAD=libpython3.11.so.1.0 ./host stickslip calls.txt
 *
 * Without a script it runs the FMU's default experiment and writes time and outputs as CSV. A
 * script (- is standard input) has one call in each line, times in s and values in SI units:
 *
 *     use NAME                  go on with this instance; the first time, make it
 *     setup T [STOP]            fmi2SetupExperiment with start time T and stop time STOP
 *     enter, exit               initialization mode
 *     set VARIABLE VALUE ...    one fmi2Set call for each type of variable
 *     get VARIABLE ...          one fmi2Get call for each type; prints the values as CSV
 *     step T H                  fmi2DoStep from communication point T by H
 *     save, restore             keep the state of the instance, go back to it
 *     reset, terminate
 *     reload                    free every instance, unload the FMU, load it again
 *     try CALL ...              print the status of the call, and go on whatever it is
 *
 * Numbers may be hexadecimal (0x1.8p1); what is printed reads back as the same number. The exit
 * code is 0 if every call succeeded, 1 if one failed, 2 for wrong use.
 */
#define _XOPEN_SOURCE 700

#include <ctype.h>
#include <dlfcn.h>
#include <errno.h>
#include <signal.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_VARIABLES = 512, MOST_INSTANCES = 64, LONGEST = 4096 };

/* What FMI 2.0 declares and this host uses, section 2.1 and 4.2 of the standard. */
typedef enum { OK, WARNING, DISCARD, ERROR, FATAL, PENDING } Status;
static const char *const status_names[] = {"ok", "warning", "discard", "error", "fatal", "pending"};

typedef struct {
    void (*logger)(void *, const char *, Status, const char *, const char *, ...);
    void *(*allocate)(size_t, size_t);
    void (*release)(void *);
    void (*step_finished)(void *, Status);
    void *environment;
} Callbacks;

static struct {
    void *(*instantiate)(const char *name, int type, const char *guid, const char *resources,
                         const Callbacks *, int visible, int logging);
    void (*free_instance)(void *);
    Status (*setup)(void *, int has_tolerance, double tolerance, double start, int has_stop,
                    double stop);
    Status (*enter)(void *);
    Status (*exit)(void *);
    Status (*terminate)(void *);
    Status (*reset)(void *);
    Status (*get_real)(void *, const unsigned *, size_t, double *);
    Status (*get_integer)(void *, const unsigned *, size_t, int *);
    Status (*get_boolean)(void *, const unsigned *, size_t, int *);
    Status (*set_real)(void *, const unsigned *, size_t, const double *);
    Status (*set_integer)(void *, const unsigned *, size_t, const int *);
    Status (*set_boolean)(void *, const unsigned *, size_t, const int *);
    Status (*step)(void *, double time, double h, int no_set_state_prior);
    Status (*get_state)(void *, void **);
    Status (*set_state)(void *, void *);
    Status (*free_state)(void *, void **);
} fmi;

enum { REAL, INTEGER, BOOLEAN, KINDS };
static const char *const kind_names[KINDS] = {"Real", "Integer", "Boolean"};

typedef struct {
    char name[128];
    unsigned reference;
    int kind;
    bool output;
} Variable;

typedef struct {
    char name[128];
    void *component;
    void *state;
} Instance;

/* The FMU: what its description says, its loaded library, and the instances made of it. */
static struct {
    char guid[128], identifier[128], resources[3 * LONGEST], library_path[LONGEST + 256];
    double start, stop, step;
    Variable variables[MOST_VARIABLES];
    size_t n_variables;
    void *library;
    Instance instances[MOST_INSTANCES];
    size_t n_instances;
} fmu;

static Instance *current;

/* Tell what is wrong, and fail. */
static Status fail(const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    fputs("host: ", stderr);
    vfprintf(stderr, format, arguments);
    fputc('\n', stderr);
    va_end(arguments);
    return ERROR;
}

/* The FMU's messages. Their text is a printf format, and what it formats follows it. */
static void show(void *environment, const char *instance, Status status, const char *category,
                 const char *format, ...) {
    va_list arguments;
    (void)environment;
    (void)category;
    va_start(arguments, format);
    fprintf(stderr, "%s: %s: ", instance, status_names[status]);
    vfprintf(stderr, format, arguments);
    fputc('\n', stderr);
    va_end(arguments);
}

static const Callbacks callbacks = {show, calloc, free, NULL, NULL};

/* Copy an attribute of the XML element that starts at `element`; false if it has none. What is
 * asked for here, numbers and identifiers, has no entities in it. */
static bool attribute(const char *element, const char *name, char *value, size_t size) {
    const size_t length = strlen(name);
    for (const char *at = element; *at && *at != '>'; at++) {
        const bool here = isspace((unsigned char)*at) && !strncmp(at + 1, name, length) &&
                          at[length + 1] == '=';
        const char *quote = here ? at + length + 2 : at;
        if (*quote != '"' && *quote != '\'') continue;
        const char *end = strchr(quote + 1, *quote);
        if (!end) return false;
        if (here) {
            const size_t n = (size_t)(end - quote - 1);
            if (n >= size) return false;
            memcpy(value, quote + 1, n);
            value[n] = '\0';
            return true;
        }
        at = end; /* over the value of another attribute */
    }
    return false;
}

static double number(const char *element, const char *name, double otherwise) {
    char text[64];
    return attribute(element, name, text, sizeof text) ? strtod(text, NULL) : otherwise;
}

/* Read a file as a text; NULL if it cannot be read. */
static char *contents(const char *path) {
    FILE *stream = fopen(path, "rb");
    char *text = NULL;
    if (!stream) return NULL;
    if (!fseek(stream, 0, SEEK_END)) {
        const long size = ftell(stream);
        rewind(stream);
        text = size < 0 ? NULL : malloc((size_t)size + 1);
        if (text) text[fread(text, 1, (size_t)size, stream)] = '\0';
    }
    fclose(stream);
    return text;
}

/* Take from the model description what a run needs. */
static Status read_description(const char *folder) {
    char path[LONGEST + 32], text[64];
    snprintf(path, sizeof path, "%s/modelDescription.xml", folder);
    char *xml = contents(path);
    if (!xml) return fail("%s: %s", path, strerror(errno));
    const char *root = strstr(xml, "<fmiModelDescription");
    const char *simulation = strstr(xml, "<CoSimulation");
    const char *experiment = strstr(xml, "<DefaultExperiment");
    Status status = OK;
    if (!root || !attribute(root, "fmiVersion", text, sizeof text) || strcmp(text, "2.0") ||
        !attribute(root, "guid", fmu.guid, sizeof fmu.guid) || !simulation ||
        !attribute(simulation, "modelIdentifier", fmu.identifier, sizeof fmu.identifier))
        status = fail("%s: no FMU 2.0 for co-simulation", path);
    fmu.stop = 1.0;
    if (experiment) {
        fmu.start = number(experiment, "startTime", 0.0);
        fmu.stop = number(experiment, "stopTime", fmu.start + 1.0);
    }
    fmu.step = (fmu.stop - fmu.start) / 1000.0;
    if (experiment) fmu.step = number(experiment, "stepSize", fmu.step);
    for (const char *at = xml; status == OK && (at = strstr(at, "<ScalarVariable ")); at++) {
        Variable *variable = &fmu.variables[fmu.n_variables];
        const char *type = strchr(at, '>');
        if (fmu.n_variables == MOST_VARIABLES) status = fail("%s: too many variables", path);
        if (status != OK || !type || !(type = strchr(type, '<'))) break;
        for (variable->kind = 0; variable->kind < KINDS; variable->kind++) {
            const size_t length = strlen(kind_names[variable->kind]);
            if (!strncmp(type + 1, kind_names[variable->kind], length)) break;
        }
        if (variable->kind < KINDS && attribute(at, "valueReference", text, sizeof text) &&
            attribute(at, "name", variable->name, sizeof variable->name)) {
            variable->reference = (unsigned)strtoul(text, NULL, 10);
            variable->output =
                attribute(at, "causality", text, sizeof text) && !strcmp(text, "output");
            fmu.n_variables++;
        }
    }
    free(xml);
    return status;
}

/* Write the path of the library, and the URI of the resources: RFC 3986 encodes all but these
 * characters in a path. */
static void locate(const char *folder) {
    snprintf(fmu.library_path, sizeof fmu.library_path, "%s/binaries/linux64/%s.so", folder,
             fmu.identifier);
    char *to = fmu.resources + sprintf(fmu.resources, "file://");
    for (const char *at = folder; *at; at++)
        if (isalnum((unsigned char)*at) || strchr("/-._~!$&'()*+,;=:@", *at))
            *to++ = *at;
        else
            to += sprintf(to, "%%%02X", (unsigned char)*at);
    strcpy(to, "/resources");
}

/* Load the FMU's library and find the functions in it. */
static Status load(void) {
    const struct {
        const char *name;
        void *slot;
    } functions[] = {
        {"fmi2Instantiate", &fmi.instantiate},
        {"fmi2FreeInstance", &fmi.free_instance},
        {"fmi2SetupExperiment", &fmi.setup},
        {"fmi2EnterInitializationMode", &fmi.enter},
        {"fmi2ExitInitializationMode", &fmi.exit},
        {"fmi2Terminate", &fmi.terminate},
        {"fmi2Reset", &fmi.reset},
        {"fmi2GetReal", &fmi.get_real},
        {"fmi2GetInteger", &fmi.get_integer},
        {"fmi2GetBoolean", &fmi.get_boolean},
        {"fmi2SetReal", &fmi.set_real},
        {"fmi2SetInteger", &fmi.set_integer},
        {"fmi2SetBoolean", &fmi.set_boolean},
        {"fmi2DoStep", &fmi.step},
        {"fmi2GetFMUstate", &fmi.get_state},
        {"fmi2SetFMUstate", &fmi.set_state},
        {"fmi2FreeFMUstate", &fmi.free_state},
    };
    fmu.library = dlopen(fmu.library_path, RTLD_NOW | RTLD_LOCAL);
    if (!fmu.library) return fail("%s", dlerror());
    for (size_t i = 0; i < sizeof functions / sizeof *functions; i++) {
        void *found = dlsym(fmu.library, functions[i].name);
        if (!found) return fail("%s", dlerror());
        memcpy(functions[i].slot, &found, sizeof found);
    }
    return OK;
}

/* Free every instance and unload the library. */
static Status unload(void) {
    for (size_t i = 0; i < fmu.n_instances; i++) {
        Instance *instance = &fmu.instances[i];
        if (instance->state) fmi.free_state(instance->component, &instance->state);
        fmi.free_instance(instance->component);
    }
    memset(fmu.instances, 0, sizeof fmu.instances);
    fmu.n_instances = 0;
    current = NULL;
    const bool closed = !fmu.library || !dlclose(fmu.library);
    fmu.library = NULL;
    return closed ? OK : fail("%s", dlerror());
}

/* Go on with the instance of this name; the first time, make it. */
static Status use(const char *name) {
    struct sigaction interrupt, broken_pipe;
    for (size_t i = 0; i < fmu.n_instances; i++)
        if (!strcmp(fmu.instances[i].name, name)) {
            current = &fmu.instances[i];
            return OK;
        }
    if (fmu.n_instances == MOST_INSTANCES) return fail("use %s: too many instances", name);
    current = &fmu.instances[fmu.n_instances];
    snprintf(current->name, sizeof current->name, "%s", name);
    /* The Python that starts here takes both signals for itself. */
    sigaction(SIGINT, NULL, &interrupt);
    sigaction(SIGPIPE, NULL, &broken_pipe);
    current->component =
        fmi.instantiate(current->name, 1, fmu.guid, fmu.resources, &callbacks, 0, 1);
    sigaction(SIGINT, &interrupt, NULL);
    sigaction(SIGPIPE, &broken_pipe, NULL);
    if (!current->component) {
        current = NULL;
        return fail("fmi2Instantiate: no instance");
    }
    fmu.n_instances++;
    return OK;
}

/* Read a number that is a word of its own. */
static bool read_number(const char *word, double *value) {
    char *end;
    *value = strtod(word, &end);
    return !*end || (fail("%s is no number", word), false);
}

static const Variable *find(const char *name) {
    for (size_t i = 0; i < fmu.n_variables; i++)
        if (!strcmp(fmu.variables[i].name, name)) return &fmu.variables[i];
    return NULL;
}

/* Get or set variables that stand next to each other and are of one type, with one call. */
static Status exchange(int kind, const unsigned *references, size_t n, double *values, bool set) {
    int whole[MOST_VARIABLES];
    void *c = current->component;
    if (kind == REAL)
        return set ? fmi.set_real(c, references, n, values)
                   : fmi.get_real(c, references, n, values);
    for (size_t i = 0; set && i < n; i++) whole[i] = (int)values[i];
    const Status status = kind == INTEGER ? (set ? fmi.set_integer(c, references, n, whole)
                                                 : fmi.get_integer(c, references, n, whole))
                                          : (set ? fmi.set_boolean(c, references, n, whole)
                                                 : fmi.get_boolean(c, references, n, whole));
    for (size_t i = 0; !set && status <= WARNING && i < n; i++) values[i] = whole[i];
    return status;
}

/* Carry out `get VARIABLE ...` or `set VARIABLE VALUE ...`. */
static Status access_variables(char **words, size_t n_words, bool set) {
    int kinds[MOST_VARIABLES];
    unsigned references[MOST_VARIABLES];
    double values[MOST_VARIABLES];
    const size_t stride = set ? 2 : 1, count = n_words / stride;
    Status status = OK;
    if (!count || n_words % stride || count > MOST_VARIABLES) return fail("wrong number of words");
    for (size_t i = 0; i < count; i++) {
        const Variable *variable = find(words[i * stride]);
        if (!variable) return fail("%s is no variable of this FMU", words[i * stride]);
        kinds[i] = variable->kind;
        references[i] = variable->reference;
        if (set && !read_number(words[2 * i + 1], &values[i])) return ERROR;
    }
    for (size_t i = 0, end; status <= WARNING && i < count; i = end) {
        for (end = i + 1; end < count && kinds[end] == kinds[i];) end++;
        status = exchange(kinds[i], references + i, end - i, values + i, set);
    }
    for (size_t i = 0; !set && status <= WARNING && i < count; i++)
        printf("%.17g%c", values[i], i + 1 < count ? ',' : '\n');
    return status;
}

static Status save(void) {
    Status status = OK;
    if (current->state) status = fmi.free_state(current->component, &current->state);
    current->state = NULL;
    return status > WARNING ? status : fmi.get_state(current->component, &current->state);
}

/* Carry out one call of a script. */
static Status call(char **words, size_t n_words) {
    const char *name = words[0];
    double numbers[2] = {0.0, 0.0};
    if (!strcmp(name, "use") && n_words == 2) return use(words[1]);
    if (!strcmp(name, "reload") && n_words == 1) return unload() == OK ? load() : ERROR;
    if (!current && use("block") > WARNING) return ERROR;
    if (!strcmp(name, "set")) return access_variables(words + 1, n_words - 1, true);
    if (!strcmp(name, "get")) return access_variables(words + 1, n_words - 1, false);
    for (size_t i = 1; i < n_words && i < 3; i++)
        if (!read_number(words[i], &numbers[i - 1])) return ERROR;
    void *c = current->component;
    if (!strcmp(name, "step") && n_words == 3) return fmi.step(c, numbers[0], numbers[1], 1);
    if (!strcmp(name, "setup") && (n_words == 2 || n_words == 3))
        return fmi.setup(c, 0, 0.0, numbers[0], n_words == 3, numbers[1]);
    if (n_words == 1) {
        if (!strcmp(name, "enter")) return fmi.enter(c);
        if (!strcmp(name, "exit")) return fmi.exit(c);
        if (!strcmp(name, "terminate")) return fmi.terminate(c);
        if (!strcmp(name, "reset")) return fmi.reset(c);
        if (!strcmp(name, "save")) return save();
        if (!strcmp(name, "restore"))
            return current->state ? fmi.set_state(c, current->state) : fail("nothing is saved");
    }
    return fail("%s is no call of this host, or has a wrong number of words", name);
}

/* Carry out a script; end at the first call that fails, unless it is only tried. */
static Status run_script(FILE *script) {
    char *line = NULL;
    size_t size = 0, number = 0;
    Status status = OK;
    setvbuf(stdout, NULL, _IOLBF, BUFSIZ); /* whoever writes the script may wait for an answer */
    while (status <= WARNING && getline(&line, &size, script) >= 0) {
        char *words[2 * MOST_VARIABLES + 2];
        size_t n_words = 0;
        number++;
        for (char *word = strtok(line, " \t\r\n"); word; word = strtok(NULL, " \t\r\n"))
            if (n_words < sizeof words / sizeof *words) words[n_words++] = word;
        const bool only_tried = n_words > 1 && !strcmp(words[0], "try");
        if (!n_words || words[0][0] == '#') continue;
        status = call(words + only_tried, n_words - only_tried);
        if (only_tried) {
            puts(status_names[status]);
            status = OK;
        } else if (status > WARNING) {
            fail("line %zu: %s: %s", number, words[0], status_names[status]);
        }
    }
    free(line);
    return status;
}

/* Run the default experiment and print time and outputs. */
static Status run_default(void) {
    char *names[MOST_VARIABLES + 1] = {"get"};
    size_t n = 0;
    printf("time");
    for (size_t i = 0; i < fmu.n_variables; i++)
        if (fmu.variables[i].output) printf(",%s", names[++n] = fmu.variables[i].name);
    putchar('\n');
    Status status = use("block");
    if (status <= WARNING) status = fmi.setup(current->component, 0, 0.0, fmu.start, 1, fmu.stop);
    if (status <= WARNING) status = fmi.enter(current->component);
    if (status <= WARNING) status = fmi.exit(current->component);
    const long steps = (long)((fmu.stop - fmu.start) / fmu.step + 0.5);
    for (long i = 0; status <= WARNING && i <= steps; i++) {
        const double time = fmu.start + (double)i * fmu.step;
        printf("%.17g,", time);
        status = call(names, n + 1);
        if (status <= WARNING && i < steps)
            status = fmi.step(current->component, time, fmu.step, 1);
    }
    if (status <= WARNING) status = fmi.terminate(current->component);
    return status <= WARNING ? status : fail("the run ended: %s", status_names[status]);
}

int main(int argc, char **argv) {
    if (argc < 2 || argc > 3) {
        fprintf(stderr, "usage: host FOLDER_OF_THE_UNZIPPED_FMU [SCRIPT]\n");
        return 2;
    }
    char *folder = realpath(argv[1], NULL);
    if (!folder || strlen(folder) >= LONGEST - 16) {
        fail("%s: %s", argv[1], folder ? "too long a path" : strerror(errno));
        free(folder);
        return 2;
    }
    FILE *script = argc < 3 ? NULL : strcmp(argv[2], "-") ? fopen(argv[2], "r") : stdin;
    Status status = OK;
    if (argc == 3 && !script) status = fail("%s: %s", argv[2], strerror(errno));
    if (status == OK) status = read_description(folder);
    locate(folder);
    if (status == OK) status = load();
    if (status == OK) status = script ? run_script(script) : run_default();
    if (unload() != OK) status = ERROR;
    if (script && script != stdin) fclose(script);
    free(folder);
    if (fflush(stdout)) status = fail("standard output: %s", strerror(errno));
    return status <= WARNING ? 0 : 1;
}
