/* Points in time as people say them, for `isotherm policy test --at`. */
#ifndef CLI_ARGUMENTS_WHEN_NEXT_H
#define CLI_ARGUMENTS_WHEN_NEXT_H

#include <stdbool.h>
#include <stdint.h>

/* Reads, in local time, "now"; a day and a time such as "sunday 9:00", "today 17:30" or "tomorrow
 * 8:00" (a "T" may stand for the blank); a time alone, which is today; or what cli_when_parse()
 * reads (when.h). A weekday is the next one whose time has not passed at `now_s`, which may be
 * today. Times are seconds since 1970. Returns false, and leaves *unix_s as it was, if the text is
 * none of these. */
bool cli_when_parse_next(const char *text, int64_t now_s, int64_t *unix_s);

enum { CLI_WHEN_DAY_SIZE = 48 };

/* Writes "Sunday 2026-11-29 at 09:00" in local time. */
void cli_when_format_day(int64_t unix_s, char text[CLI_WHEN_DAY_SIZE]);

#endif
