/* Writes one JSON object on one line, into memory of its own. */
#ifndef ISO_FIRMWARE_CONTRACT_JSON_LINE_H
#define ISO_FIRMWARE_CONTRACT_JSON_LINE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct iso_json_line {
    char text[3072]; /* terminated at all times */
    size_t length;
    bool overflow; /* something did not fit; the text is of no use */
};

void iso_json_line_begin(struct iso_json_line *line);

/* Members, in the order they shall have; keys need no escaping. */
void iso_json_line_integer(struct iso_json_line *line, const char *key, int64_t value);

/* Six significant digits; null if it is not finite, for JSON has no such numbers. */
void iso_json_line_number(struct iso_json_line *line, const char *key, double value);

/* Quotes, backslashes and control characters are escaped; a byte that is no UTF-8 becomes U+FFFD.
 */
void iso_json_line_string(struct iso_json_line *line, const char *key, const char *value);

/* Ends the object and the line. Returns its length with the newline, or 0 if it did not fit. */
size_t iso_json_line_end(struct iso_json_line *line);

#endif
