/* Texts of numbers, refusals and warnings: those of the Python FMU, to the letter.
 *
 * Nothing here depends on the locale. A text is only made when a message is. */
#ifndef STICKSLIP_TEXT_H
#define STICKSLIP_TEXT_H

#include "refusal.h"
#include "table.h"

#include <stdbool.h>

enum {
    NUMBER_SIZE = 48,  /* texts have up to 24 characters; compilers ask for what they can prove */
    MESSAGE_SIZE = 320 /* any message about this FMU; longer ones are cut */
};

/* The shortest decimal text that reads back as the number, in the form of Python's repr. */
void number_text(double value, char text[NUMBER_SIZE]);

/* Whether a variable can take a value. */
bool in_range(const struct row *row, double value);

/* Why a variable cannot take a value: name, value, unit and range. */
void range_text(const struct row *row, double value, char text[MESSAGE_SIZE]);

/* Why the block refused these settings, or a step [s] from this time [s]. */
void refusal_text(enum refusal refusal, const struct settings *settings, double time, double step,
                  char text[MESSAGE_SIZE]);

/* That the friction law takes these settings, but not as they were given: LAW.warns. */
void warning_text(const struct settings *settings, char text[MESSAGE_SIZE]);

/* Whether two settings have the same warning_text. */
bool same_warning(const struct settings *one, const struct settings *other);

#endif
