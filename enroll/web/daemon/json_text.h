/* Parts of a JSON text, for long answers: a tree of jansson needs a thousand bytes for each person
 * of a list, the text a tenth of that. */
#ifndef WEB_DAEMON_JSON_TEXT_H
#define WEB_DAEMON_JSON_TEXT_H

#include <stdint.h>
#include <stdio.h>

/* Writes a string with its quotes. `text` is valid UTF-8. */
void web_json_text(FILE *out, const char *text);

/* A time as RFC 3339, UTC: "2026-11-21T08:33:20Z". Returns the text. */
enum { WEB_TIME_TEXT_SIZE = 32 };
const char *web_time_text(int64_t seconds, char text[WEB_TIME_TEXT_SIZE]);

/* The seconds since 1970 of such a text, fractions of a second ignored; 0 for another text. */
int64_t web_time_read(const char *text);

#endif
