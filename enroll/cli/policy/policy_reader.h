/* Reads a file that somebody else may have written, in a process of its own. The program
 * isotherm-policy-reader has neither files nor network and few seconds; so a file that exploits a
 * fault of a library for TOML or iCalendar gains nothing. */
#ifndef CLI_POLICY_POLICY_READER_H
#define CLI_POLICY_POLICY_READER_H

#include <jansson.h>
#include <stdbool.h>

#include "enroll/cli/client/fault.h"

/* Reads FILE.json, FILE.toml or FILE.ics. The caller releases *out, an object: a policy, or of a
 * calendar its special day groups and schedules alone. *is_calendar says which. `zone` is the time
 * zone of times of a calendar without one; NULL: there is none. `program` is the path of
 * isotherm-policy-reader; without that program only JSON is read.
 *
 *   CLI_EXIT_USAGE      "usage" for another kind of file; "invalid-policy" for what cannot be read
 *   CLI_EXIT_NOT_FOUND  "no-file", also for another format than JSON without the program
 *   CLI_EXIT_FAULT      the file cannot be opened, or the program cannot be run */
enum cli_exit cli_policy_read_file(const char *program, const char *file, const char *zone,
                                   json_t **out, bool *is_calendar, struct cli_fault *fault)
    __attribute__((warn_unused_result));

/* Adds the special day groups and schedules of a calendar to a policy, both as objects. Records of
 * the same token are replaced. Returns false without memory, or if the policy has an array that is
 * none. */
bool cli_policy_merge(json_t *policy, const json_t *calendar);

#endif
