/* A refusal tells a code and not the value and its range.
 * replaces: range_text
 * detected by: call-sequences in 300 sequences
 */
#include "text.h"

#include <stdio.h>

void range_text(const struct row *row, double value, char text[MESSAGE_SIZE])
{
    (void)value;
    snprintf(text, MESSAGE_SIZE, "error %d", (int)(row - ROWS));
}
