/* Writes one JSON object on one line, into memory of its own. */
#ifndef ISO_FIRMWARE_CONTRACT_JSON_LINE_H
#define ISO_FIRMWARE_CONTRACT_JSON_LINE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct iso_json_line {
    char text[3072]; /* always ends with a NUL */
    size_t length;
    bool overflow; /* something did not fit, so the text must not be used */
};

/* Begins an empty object. */
void iso_json_line_begin(struct iso_json_line *line);

/* Members, in the order of the calls. Keys need no escaping. */
void iso_json_line_integer(struct iso_json_line *line, const char *key, int64_t value);

/* Writes six significant digits, or null if the number is not finite, because JSON has no such
 * numbers. */
void iso_json_line_number(struct iso_json_line *line, const char *key, double value);

/* Escapes quotes, backslashes and control characters. A byte that is not UTF-8 becomes U+FFFD. */
void iso_json_line_string(struct iso_json_line *line, const char *key, const char *value);

/* Ends the object and the line. Returns its length with the newline, or 0 if it did not fit. */
size_t iso_json_line_end(struct iso_json_line *line);

#endif
