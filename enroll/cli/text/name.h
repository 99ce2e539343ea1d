/* Names of people as a client compares and prints them. The rule of the daemon says which spellings
 * are one name (firmware/contract/name_folding.h). */
#ifndef CLI_TEXT_NAME_H
#define CLI_TEXT_NAME_H

#include <stdbool.h>
#include <stdio.h>

/* Whether two names belong to one person. Names that are not UTF-8 are compared byte by byte, and
 * so are all names if there is no memory. */
bool cli_name_is_same(const char *a, const char *b);

/* Prints a name in the syntax of a shell, so that invisible characters can be seen and typed:
 * $'A\u200Bda'. */
void cli_name_print(FILE *out, const char *name);

#endif
