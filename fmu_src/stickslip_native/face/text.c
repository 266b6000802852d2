/* Texts of numbers, refusals and warnings: see the header. */
#include "text.h"

#include "block.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Digits that most numbers have that people type, and those that tell any two doubles apart. */
enum { FEWEST_DIGITS = 15, MOST_DIGITS = 17 };

void number_text(double value, char text[NUMBER_SIZE])
{
    for (int digits = FEWEST_DIGITS; digits <= MOST_DIGITS; digits++) {
        snprintf(text, NUMBER_SIZE, "%.*g", digits, value);
        if (strtod(text, NULL) == value) break;
    }
    if (isnan(value)) snprintf(text, NUMBER_SIZE, "nan");
    /* The decimal point is that of the locale. */
    char *point = strchr(text, ',');
    const size_t length = strlen(text);
    if (point != NULL) *point = '.';
    if (isfinite(value) && strpbrk(text, ".e") == NULL)
        snprintf(text + length, NUMBER_SIZE - length, ".0");
}

/* The text of a whole number, as that of an Integer. */
static void whole_text(double value, char text[NUMBER_SIZE])
{
    snprintf(text, NUMBER_SIZE, "%.0f", value);
}

bool in_range(const struct row *row, double value)
{
    return isfinite(value) && (row->kind == REAL || value == floor(value)) &&
           (!row->has_minimum || value >= row->minimum) &&
           (!row->has_maximum || value <= row->maximum);
}

void range_text(const struct row *row, double value, char text[MESSAGE_SIZE])
{
    char number[NUMBER_SIZE];
    /* "Above 0" means the smallest number with all its digits: subnormal ones have lost some. */
    bool subnormal = row->has_minimum && row->minimum == DBL_MIN && value > 0.0 && value < DBL_MIN;

    if (row->kind == REAL || value != floor(value))
        number_text(value, number);
    else
        whole_text(value, number);
    snprintf(text, MESSAGE_SIZE, "%s = %s%s%s is out of range: it must be %s%s", row->name, number,
             row->unit[0] == '\0' ? "" : " ", row->unit, row->range,
             subnormal ? ", at least 2.23e-308" : "");
}

/* The text that stands in a hole for a value. */
static void hole_text(char kind, double value, char text[NUMBER_SIZE])
{
    if (kind == 'n')
        snprintf(text, NUMBER_SIZE, "%s", ROWS[(int)value].name);
    else if (kind == 'd')
        whole_text(value, text);
    else
        number_text(value, text);
}

/* Write a remark behind what stands in the text; what does not fit is cut. */
static void append(char text[MESSAGE_SIZE], const struct remark *remark)
{
    char hole[NUMBER_SIZE];
    size_t length = strlen(text);
    int taken = 0;

    for (const char *next = remark->text; *next != '\0' && length + 1 < MESSAGE_SIZE; next++) {
        if (*next == '%' && taken < MOST_VALUES) {
            hole_text(*++next, remark->values[taken++], hole);
            snprintf(text + length, MESSAGE_SIZE - length, "%s", hole);
            length = strlen(text);
        } else {
            text[length++] = *next;
            text[length] = '\0';
        }
    }
}

void remarks_text(const struct remark remarks[], int count, char text[MESSAGE_SIZE])
{
    static const struct remark BETWEEN = {"; ", {0.0}};
    text[0] = '\0';
    for (int n = 0; n < count; n++) {
        if (n > 0) append(text, &BETWEEN);
        append(text, &remarks[n]);
    }
}

void refusal_text(enum refusal refusal, const struct settings *settings, double time, double step,
                  char text[MESSAGE_SIZE])
{
    char one[NUMBER_SIZE], two[NUMBER_SIZE], three[NUMBER_SIZE];
    struct remark why = {"", {0.0}};

    switch (refusal) {
    case LIFTED_OFF:
        number_text(settings->load, one);
        number_text(-(settings->m * settings->g), two);
        snprintf(text, MESSAGE_SIZE,
                 "load = %s N is out of range: it must be at least -m g = %s N, "
                 "or the mass lifts off",
                 one, two);
        break;
    case RATES_OUT_OF_RANGE:
        number_text(settings->k, one);
        number_text(settings->m, two);
        number_text(settings->c, three);
        snprintf(text, MESSAGE_SIZE,
                 "k = %s N/m, m = %s kg, c = %s N.s/m are out of range together: "
                 "their rates leave the range of double-precision numbers",
                 one, two, three);
        break;
    case STEP_OUT_OF_RANGE:
        number_text(step, one);
        snprintf(text, MESSAGE_SIZE, "step size h = %s s is out of range: above 0 and finite", one);
        break;
    case TIME_OUT_OF_RANGE:
        number_text(time, one);
        snprintf(text, MESSAGE_SIZE,
                 "communication point t = %s s is out of range: a finite number", one);
        break;
    case TOO_MANY_TRANSITIONS:
        number_text(step, one);
        snprintf(text, MESSAGE_SIZE,
                 "step size h = %s s is out of range: it holds more than %d %s; make it shorter",
                 one, MOST_TRANSITIONS,
                 LAW.whole ? "strides of the integration" : "transitions between stick and slip");
        break;
    case LAW_REFUSES:
        LAW.refuses(settings, &why);
        remarks_text(&why, 1, text);
        break;
    case NOT_FOLLOWED:
        if (LAW.refuses != NULL && LAW.refuses(settings, &why))
            remarks_text(&why, 1, text);
        else
            snprintf(text, MESSAGE_SIZE,
                     "the motion is stiffer than double-precision numbers can follow");
        break;
    case NO_SUCH_STATE:
        snprintf(text, MESSAGE_SIZE, "the saved state has values that no block reaches");
        break;
    case NOT_FINITE:
    case ACCEPTED:
    default:
        snprintf(text, MESSAGE_SIZE,
                 "the motion or its forces leave the range of double-precision numbers");
        break;
    }
}

bool same_remark(const struct remark *one, const struct remark *other)
{
    /* The texts of 0.0 and -0.0 differ, so the bits are compared. */
    return strcmp(one->text, other->text) == 0 &&
           memcmp(one->values, other->values, sizeof one->values) == 0;
}
