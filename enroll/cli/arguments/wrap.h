/* Text in lines of 80 columns. */
#ifndef CLI_ARGUMENTS_WRAP_H
#define CLI_ARGUMENTS_WRAP_H

#include <stdio.h>

enum { CLI_WRAP_COLUMNS = 80 };

/* Prints a text and a line end. The text begins at `column`, the present column of the output, and
 * each further line begins at that column, too. Lines are broken at blanks only. */
void cli_wrap(const char *text, int column, FILE *out);

#endif
