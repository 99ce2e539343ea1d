/* Texts in columns: how many columns of a terminal a text takes, whatever letters it has. Chinese,
 * Japanese and Korean letters take two, combining marks none. The locale of the program has no
 * effect, because texts are UTF-8. */
#ifndef ISO_DRIVERS_TERMINAL_COLUMNS_H
#define ISO_DRIVERS_TERMINAL_COLUMNS_H

#include <stddef.h>
#include <stdio.h>

/* Columns that the text takes when iso_columns_print() prints it. */
size_t iso_columns_of(const char *utf8);

/* Prints the text, and blanks up to `columns` if it takes fewer. Characters that cannot be printed
 * (such as control characters, which a name must not send to a terminal) and bytes that are not
 * UTF-8 are printed as '?'. */
void iso_columns_print(FILE *out, const char *utf8, size_t columns);

#endif
