/* The calls that the host makes, in either version of FMI: each returns the status. */
#ifndef FACE_H
#define FACE_H

#include <stddef.h>

/* A function of the library, and the pointer to it that gets its address. */
struct function {
    const char *name;
    void *slot;
};

extern const struct function FUNCTIONS[];
extern const size_t FUNCTION_COUNT;

/* Print a message of the FMU. */
void show(const char *instance, int status, const char *category, const char *text);

/* An instance, NULL if the FMU refuses; its GUID or instantiation token. */
void *face_make(const char *identity);

/* The start time [s] is given before the initialization. */
int face_setup(void *slave, double start_time);
int face_enter(void *slave);

/* A communication step [s]. */
int face_step(void *slave, double time, double step);

int face_set(void *slave, const unsigned references[], size_t count, const double values[]);
int face_real(void *slave, const unsigned references[], size_t count, double values[]);
int face_integer(void *slave, const unsigned references[], size_t count, int values[]);
int face_enumeration(void *slave, const unsigned references[], size_t count, int values[]);
int face_boolean(void *slave, const unsigned references[], size_t count, int values[]);

/* Functions of the library that are called alike in both versions. */
extern void (*face_free)(void *slave);
extern int (*face_exit)(void *slave), (*face_terminate)(void *slave), (*face_reset)(void *slave);
extern int (*face_get_state)(void *slave, void **state);
extern int (*face_set_state)(void *slave, void *state);
extern int (*face_free_state)(void *slave, void **state);
extern int (*face_state_size)(void *slave, void *state, size_t *size);
extern int (*face_write_state)(void *slave, void *state, char bytes[], size_t size);
extern int (*face_read_state)(void *slave, const char bytes[], size_t size, void **state);

#endif
