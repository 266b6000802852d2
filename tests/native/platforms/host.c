/* Runs calls in the library of an FMU 2.0 or 3.0 for co-simulation, on any platform.
 *
 *     host LIBRARY IDENTITY < calls
 *
 * Each line of standard input is a call; the answer is a line of standard output, the number of the
 * status, then what was read. The messages of the FMU come as lines of their own before it. Numbers
 * are hexadecimal, so that no digit is lost.
 *
 *     setup T, enter, exit, terminate, reset
 *     step T H                  a communication step of H [s] from T [s]
 *     set REFERENCE VALUE ...   real variables
 *     real, integer, enumeration, boolean REFERENCE ...
 *     save, restore             the state is kept in memory, and taken up
 *     write, read BYTES         the state as bytes, each two hexadecimal digits
 *
 * The exit code is 2 where the library or a line of the input cannot be used.
 */
#include "face.h"

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

void (*face_free)(void *);
int (*face_exit)(void *), (*face_terminate)(void *), (*face_reset)(void *);
int (*face_get_state)(void *, void **), (*face_set_state)(void *, void *);
int (*face_free_state)(void *, void **), (*face_state_size)(void *, void *, size_t *);
int (*face_write_state)(void *, void *, char *, size_t);
int (*face_read_state)(void *, const char *, size_t, void **);

static void fail(const char *cause, const char *which)
{
    fprintf(stderr, "host: %s: %s\n", cause, which);
    exit(2);
}

void show(const char *instance, int status, const char *category, const char *text)
{
    printf("%s %d %s: %s\n", instance, status, category, text);
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
    int status = face_get_state(slave, &state);
    if (status == 0) status = face_state_size(slave, state, &size);
    if (size > sizeof bytes) fail("a state is too long", "");
    if (status == 0) status = face_write_state(slave, state, bytes, size);
    printf("%d ", status);
    for (size_t n = 0; n < size && status == 0; n++) printf("%02x", (unsigned char)bytes[n]);
    putchar('\n');
    face_free_state(slave, &state);
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
    int status = face_read_state(slave, bytes, size, &state);
    if (status == 0) status = face_set_state(slave, state);
    if (state != NULL) face_free_state(slave, &state);
    return status;
}

/* Carry out one line, and print the answer. */
static void answer(void *slave, const char *call)
{
    static const struct {
        const char *name;
        int (*get)(void *, const unsigned[], size_t, int[]);
    } WHOLE[] = {{"integer", face_integer},
                 {"enumeration", face_enumeration},
                 {"boolean", face_boolean}};
    static void *state;
    unsigned references[MOST];
    double values[MOST];
    int integers[MOST], status = 0;
    if (strcmp(call, "real") == 0) {
        const size_t count = list(references, NULL);
        status = face_real(slave, references, count, values);
        print_reals(status, values, count);
        return;
    }
    for (size_t n = 0; n < sizeof WHOLE / sizeof *WHOLE; n++)
        if (strcmp(call, WHOLE[n].name) == 0) {
            const size_t count = list(references, NULL);
            status = WHOLE[n].get(slave, references, count, integers);
            print_integers(status, integers, count);
            return;
        }
    if (strcmp(call, "write") == 0) {
        print_bytes(slave);
        return;
    }
    if (strcmp(call, "set") == 0) {
        const size_t count = list(references, values);
        status = face_set(slave, references, count, values);
    } else if (strcmp(call, "step") == 0) {
        const double time = number();
        status = face_step(slave, time, number());
    } else if (strcmp(call, "setup") == 0) {
        status = face_setup(slave, number());
    } else if (strcmp(call, "enter") == 0) {
        status = face_enter(slave);
    } else if (strcmp(call, "exit") == 0) {
        status = face_exit(slave);
    } else if (strcmp(call, "terminate") == 0) {
        status = face_terminate(slave);
    } else if (strcmp(call, "reset") == 0) {
        status = face_reset(slave);
    } else if (strcmp(call, "save") == 0) {
        status = face_get_state(slave, &state);
    } else if (strcmp(call, "restore") == 0) {
        status = face_set_state(slave, state);
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
    if (count != 3) fail("use", "host LIBRARY IDENTITY < calls");
    for (size_t n = 0; n < FUNCTION_COUNT; n++) {
        void (*found)(void) = function_in(arguments[1], FUNCTIONS[n].name);
        if (found == NULL) fail("the library cannot be loaded, or lacks", FUNCTIONS[n].name);
        memcpy(FUNCTIONS[n].slot, &found, sizeof found);
    }
    void *slave = face_make(arguments[2]);
    if (slave == NULL) fail("no instance with identity", arguments[2]);
    while (fgets(line, sizeof line, stdin) != NULL) {
        const char *call = strtok(line, " \r\n");
        if (call != NULL) answer(slave, call);
    }
    face_free(slave);
    return 0;
}
