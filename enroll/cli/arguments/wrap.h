/* Text in lines of 80 columns. */
#ifndef CLI_ARGUMENTS_WRAP_H
#define CLI_ARGUMENTS_WRAP_H

#include <stdio.h>

enum { CLI_WRAP_COLUMNS = 80 };

/* Prints a text and a line end. It begins at `column`, where the output stands already, and goes on
 * there on the next line instead of going beyond the last column. It is broken at blanks only. */
void cli_wrap(const char *text, int column, FILE *out);

#endif
