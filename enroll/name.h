/* Which spellings of a name are one person's: "Ada" and "ada", or "é" in one character and in two.
 * The rule is the daemon's (firmware/person_name.h), so that the client finds whom the daemon does.
 */
#ifndef CLI_NAME_H
#define CLI_NAME_H

#include <stdbool.h>

/* Whether two names are one person's. Names that are not UTF-8 are compared byte by byte, and so
 * are all of them for want of memory. */
bool cli_name_is_same(const char *a, const char *b);

#endif
