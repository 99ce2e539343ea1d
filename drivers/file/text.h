/* Small text files of plain format: read whole into memory; core/base/text.h takes them apart. */
#ifndef ISO_DRIVERS_FILE_TEXT_H
#define ISO_DRIVERS_FILE_TEXT_H

#include <stddef.h>
#include <stdio.h>

#include "core/base/fault.h"
#include "core/base/text.h"

/* Reads a file of at most max_bytes as a string that the caller frees with free(). -EBADMSG if it
 * holds a NUL byte, or the errors of iso_file_read (drivers/file/file.h); each with a fault that
 * names the file. */
int iso_text_read(const char *path, size_t max_bytes, char **text, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* The number, from 1, of the first line that is longer than max_bytes, or 0. libinih cuts lines
 * silently at 200 bytes; longer lines are therefore refused before libinih reads them. */
int iso_text_find_long_line(const char *text, size_t max_bytes);

enum { ISO_TEXT_INI_LINE_MAX = 190 };

/* Prints "KEY = VALUE\n" with the fewest digits (at least 15) from which the same double is read
 * back. */
void iso_text_print_number(FILE *stream, const char *key, double value);

/* Copies a text, or its end with "..." before it if it does not fit into `size` bytes (8 or more).
 */
void iso_text_copy_end(const char *text, char *to, size_t size);

#endif
