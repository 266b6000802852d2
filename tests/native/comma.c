/* A C library whose locale has a decimal comma: what text.c calls of it. */
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int comma_snprintf(char *text, size_t size, const char *format, ...)
{
    va_list arguments;
    char *point;
    va_start(arguments, format);
    const int length = vsnprintf(text, size, format, arguments);
    va_end(arguments);
    if (strcmp(format, "%.*g") == 0 && (point = strchr(text, '.')) != NULL) *point = ',';
    return length;
}

double comma_strtod(const char *text, char **end)
{
    char changed[100];
    char *mark;
    strcpy(changed, text);
    if ((mark = strchr(changed, '.')) != NULL) *mark = '\0';
    if ((mark = strchr(changed, ',')) != NULL) *mark = '.';
    return strtod(changed, end);
}
