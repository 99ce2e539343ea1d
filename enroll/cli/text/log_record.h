/* Records of the audit log for people: which ones are selected, and their members in columns. A
 * member that the table in log_record.c does not have is shown as it is. */
#ifndef CLI_TEXT_LOG_RECORD_H
#define CLI_TEXT_LOG_RECORD_H

#include <jansson.h>
#include <stdint.h>
#include <stdio.h>

#include "enroll/cli/arguments/arguments.h"

/* The record's own number; 0 if it has none. */
uint64_t cli_log_sequence(const json_t *record);

/* When it was written, in seconds since 1970; 0 if it has no time. */
int64_t cli_log_time_s(const json_t *record);

/* Whether options select only some of the records. */
bool cli_log_chooses(const struct cli_arguments *arguments);

/* Whether the record is of the people, the day and the events that were asked for. People are
 * compared as the daemon does it (enroll/cli/text/name.h); a rename is of its old name and of its
 * new one.
 */
bool cli_log_matches(const json_t *record, const struct cli_arguments *arguments);

/* "17 2026-11-21 09:30:15 visit verdict=allow person=anna score=4.12 ...": local time, scores with
 * two digits; with `full` every digit and the members that are for programs, too. */
void cli_log_print_text(const json_t *record, bool full, FILE *out);

/* A line of values separated by commas (RFC 4180, with a line feed), and the line that names them.
 */
void cli_log_print_csv(const json_t *record, bool full, FILE *out);
void cli_log_print_csv_head(bool full, FILE *out);

#endif
