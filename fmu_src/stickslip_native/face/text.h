/* Texts of numbers, refusals and warnings: those of the Python FMU, but for the form of numbers.
 *
 * Nothing here depends on the locale. A text is only made when a message is. */
#ifndef STICKSLIP_TEXT_H
#define STICKSLIP_TEXT_H

#include "refusal.h"
#include "remark.h"
#include "table.h"

#include <stdbool.h>

enum {
    NUMBER_SIZE = 48,  /* texts have up to 24 characters; compilers ask for what they can prove */
    MESSAGE_SIZE = 512 /* any message about this FMU; longer ones are cut */
};

/* A text that reads back as the number, of 15 digits where they do; 1.0 and not 1. */
void number_text(double value, char text[NUMBER_SIZE]);

/* Whether a variable can take a value. */
bool in_range(const struct row *row, double value);

/* Why a variable cannot take a value: name, value, unit and range. */
void range_text(const struct row *row, double value, char text[MESSAGE_SIZE]);

/* Why the block refused these settings, or a step [s] from this time [s]. */
void refusal_text(enum refusal refusal, const struct settings *settings, double time, double step,
                  char text[MESSAGE_SIZE]);

/* All remarks of the friction law on settings, one behind the other. */
void remarks_text(const struct remark remarks[], int count, char text[MESSAGE_SIZE]);

/* Whether two remarks have the same text. */
bool same_remark(const struct remark *one, const struct remark *other);

#endif
