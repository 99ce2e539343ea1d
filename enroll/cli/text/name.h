/* Which spellings of a name are one person's: "Ada" and "ada", "é" in one character and in two, or
 * with and without characters that are not seen.
 * The rule is the daemon's (firmware/contract/person_name.h), so that the client finds whom the
 * daemon does.
 */
#ifndef CLI_TEXT_NAME_H
#define CLI_TEXT_NAME_H

#include <stdbool.h>
#include <stdio.h>

/* Whether two names are one person's. Names that are not UTF-8 are compared byte by byte, and so
 * are all of them for want of memory. */
bool cli_name_is_same(const char *a, const char *b);

/* The text that all spellings of a name have in common: Unicode's case folding and compatibility
 * composition (NFKC), twice as the daemon does it, because a square MHz becomes letters with a case
 * only by the first normalisation; without what is not seen. NULL if the name is not UTF-8, or for
 * want of memory; the caller frees it. */
char *cli_name_fold(const char *name);

/* Prints a name as a shell reads it, so that what is not seen can be told and typed:
 * $'A\u200Bda'. */
void cli_name_print(FILE *out, const char *name);

#endif
