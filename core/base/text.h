/* The contents of text files of plain format, read strictly: line by line, field by field. */
#ifndef ISO_CORE_BASE_TEXT_H
#define ISO_CORE_BASE_TEXT_H

#include <stddef.h>

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

/* Reads a decimal number. The whole string must be one finite number of digits, sign, point and
 * exponent, without spaces, hexadecimal digits or names; otherwise -EINVAL. */
int iso_text_number(const char *text, double *out) __attribute__((warn_unused_result));

/* Reads a count. The whole string must be 1 to 18 decimal digits, otherwise -EINVAL. */
int iso_text_count(const char *text, size_t *out) __attribute__((warn_unused_result));

#endif
