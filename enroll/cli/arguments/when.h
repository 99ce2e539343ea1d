/* Points in time on the command line and in lists. */
#ifndef CLI_ARGUMENTS_WHEN_H
#define CLI_ARGUMENTS_WHEN_H

#include <stdbool.h>
#include <stdint.h>

/* Reads "2026-11-21", "2026-11-21T08:30", "2026-11-21T08:30:15" (a blank may stand for the T), in
 * local time, or with a final "Z" in UTC, or "@1795248000" (seconds since 1970). A date alone means
 * its first second, or with `end_of_day` its last. Dates that do not exist (30 February) and times
 * before 1970 are refused. Returns false, and leaves *unix_s as it was, if the text is none of
 * these. */
bool cli_when_parse(const char *text, bool end_of_day, int64_t *unix_s);

/* Reads a day of local time: "2026-11-21", "today" or "yesterday", as of `now_s` (all three are
 * seconds since 1970). The day goes from its first second to the first of the next one, which is
 * not part of it. Returns false, and leaves the outputs as they were, if the text is not a day. */
bool cli_when_parse_day(const char *text, int64_t now_s, int64_t *begins_s, int64_t *ends_s);

enum { CLI_WHEN_SIZE = 32 };

/* Writes "2026-11-21 08:30" in local time; "-" for 0, which on the bus means no limit. */
void cli_when_format(int64_t unix_s, char text[CLI_WHEN_SIZE]);

/* Writes "2026-11-21 08:30:15" in local time. */
void cli_when_format_second(int64_t unix_s, char text[CLI_WHEN_SIZE]);

#endif
