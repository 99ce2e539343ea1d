/* Names of people as a client compares and prints them. Which spellings are one name is the rule of
 * the daemon (firmware/contract/name_folding.h). */
#ifndef CLI_TEXT_NAME_H
#define CLI_TEXT_NAME_H

#include <stdbool.h>
#include <stdio.h>

/* Whether two names are one person's. Names that are not UTF-8 are compared byte by byte, and so
 * are all of them for want of memory. */
bool cli_name_is_same(const char *a, const char *b);

/* Prints a name as a shell reads it, so that what is not seen can be told and typed:
 * $'A\u200Bda'. */
void cli_name_print(FILE *out, const char *name);

#endif
