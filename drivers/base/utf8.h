/* Reading UTF-8 strictly (RFC 3629). */
#ifndef ISO_DRIVERS_BASE_UTF8_H
#define ISO_DRIVERS_BASE_UTF8_H

#include <stdbool.h>
#include <stdint.h>

/* Decodes the character at the beginning of a NUL-terminated text. Returns its length in bytes,
 * 1..4; or 0, with *character unchanged, if the bytes are not UTF-8 (also an overlong sequence, a
 * surrogate, a character beyond U+10FFFF, or one that is cut short). The terminating NUL counts as
 * a character of length 1. */
int iso_utf8_decode(const char *text, uint32_t *character);

/* Whether all of a NUL-terminated text is UTF-8. */
bool iso_utf8_is_valid(const char *text);

#endif
