/* Values of options, as functions that take nothing else. */
#ifndef CLI_ARGUMENTS_VALUE_H
#define CLI_ARGUMENTS_VALUE_H

#include <stdbool.h>

/* A whole number, 1 to max, in decimal digits. False, *out untouched, if the text is none. */
bool cli_value_count(const char *text, unsigned long long max, unsigned long long *out);

/* More than 0 and at most a day of seconds. False, *out untouched, if the text is none. */
bool cli_value_seconds(const char *text, double *out);

#endif
