/* Reads the numbers of options. */
#ifndef CLI_ARGUMENTS_VALUE_H
#define CLI_ARGUMENTS_VALUE_H

#include <stdbool.h>

/* Reads a whole number, 1 to max, in decimal digits. Returns false, and leaves *out as it was, if
 * the text is not one. */
bool cli_value_count(const char *text, unsigned long long max, unsigned long long *out);

/* Reads a number of seconds above 0 and up to one day; fractions are allowed. Returns false, and
 * leaves *out as it was, if the text is not one. */
bool cli_value_seconds(const char *text, double *out);

#endif
