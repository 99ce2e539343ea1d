/* The readers of isotherm-policy-reader: from the bytes of a file to a JSON object. They are plain
 * functions without files, so that tests call them. */
#ifndef ISO_ENROLL_POLICY_READER_READER_INPUT_H
#define ISO_ENROLL_POLICY_READER_READER_INPUT_H

#include <jansson.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { READER_LINE_SIZE = 256 };

/* A line for people about a file that is refused; "" if it is not. */
struct reader_line {
    char text[READER_LINE_SIZE];
};

/* Writes the line; control characters become '?'. Returns NULL, so that a reader can return it. */
json_t *reader_refuse(struct reader_line *line, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/* JSON. Returns a new object that the caller releases, or NULL with a line. The same for the two
 * functions below. `text` has `size` bytes and a zero byte after them. */
json_t *reader_json(const char *text, size_t size, struct reader_line *line);

/* TOML 1.0. Tables become objects. Dates may be written without quotes; times and points in time
 * are refused, because no member of a policy is one. */
json_t *reader_toml(const char *text, size_t size, struct reader_line *line);

/* iCalendar (RFC 5545). Returns the members "special_day_groups" and "schedules" of a policy;
 * ics.h says what becomes of an event. `zone` is the time zone of times without one, or NULL.
 * `today` is the present date as YYYYMMDD. */
json_t *reader_ics(const char *text, size_t size, const char *zone, int today,
                   struct reader_line *line);

#ifdef __cplusplus
}
#endif

#endif
