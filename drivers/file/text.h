/* Small text files of plain format, read strictly: whole into memory, line by line, field by
 * field. */
#ifndef ISO_DRIVERS_FILE_TEXT_H
#define ISO_DRIVERS_FILE_TEXT_H

#include <stddef.h>
#include <stdio.h>

#include "core/base/fault.h"

/* Reads a file of at most max_bytes as a string that the caller frees with free(). -EBADMSG if it
 * holds a NUL byte, or the errors of iso_file_read (drivers/file/file.h); each with a fault that
 * names the file. */
int iso_text_read(const char *path, size_t max_bytes, char **text, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Iterates over the lines of a string. The end of each line is overwritten with NUL. */
struct iso_text_lines {
    char *rest;
    unsigned number; /* of the line returned last, from 1 */
};

/* Begins with the first line. The text must outlive the iteration. */
struct iso_text_lines iso_text_lines_of(char *text);

/* The next line without its end ("\n" or "\r\n"), or NULL after the last. */
char *iso_text_next_line(struct iso_text_lines *lines);

/* An upper bound of how many lines iso_text_next_line will find. */
size_t iso_text_line_count(const char *text);

/* Cuts a line at every separator; returns how many fields there are and stores the first max of
 * them. An empty line is one empty field. */
size_t iso_text_split(char *line, char separator, char **fields, size_t max);

/* The same, but words are separated by one or more spaces and tabs, and those at the ends of the
 * line do not count: a blank line has no words.
 */
size_t iso_text_words(char *line, char **words, size_t max);

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

/* A decimal number, the whole string, finite: digits, sign, point, exponent; no spaces, no
 * hexadecimal, no names. -EINVAL else. */
int iso_text_number(const char *text, double *out) __attribute__((warn_unused_result));

/* A count, the whole string: 1 to 18 decimal digits. -EINVAL else. */
int iso_text_count(const char *text, size_t *out) __attribute__((warn_unused_result));

#endif
