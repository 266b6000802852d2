/* Numbers in messages have the decimal comma of a locale.
 * replaces: number_text
 * detected by: texts
 */
#include "text.h"

#include <string.h>

void true_number_text(double value, char text[NUMBER_SIZE]);

void number_text(double value, char text[NUMBER_SIZE])
{
    true_number_text(value, text);
    char *point = strchr(text, '.');
    if (point != NULL) *point = ',';
}
