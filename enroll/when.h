/* Points in time as people write them on a command line and read them in a list. */
#ifndef CLI_WHEN_H
#define CLI_WHEN_H

#include <stdbool.h>
#include <stdint.h>

/* Reads "2026-11-21", "2026-11-21T08:30", "2026-11-21T08:30:15" (a blank may stand for the T), in
 * local time, or with a final "Z" in UTC, or "@1795248000" (seconds since 1970). A date alone means
 * its first second, or with `end_of_day` its last. Dates that do not exist (30 February) and times
 * before 1970 are refused. Returns false, leaving *unix_s alone, if the text is none of these. */
bool cli_when_parse(const char *text, bool end_of_day, int64_t *unix_s);

enum { CLI_WHEN_SIZE = 32 };

/* "2026-11-21 08:30" in local time; "-" for 0, which on the bus means no limit. */
void cli_when_format(int64_t unix_s, char text[CLI_WHEN_SIZE]);

#endif
