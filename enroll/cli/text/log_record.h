/* Records of the audit log for people: which ones are selected, and their members in columns. A
 * member that the table in log_record.c does not have is shown as it is. */
#ifndef CLI_TEXT_LOG_RECORD_H
#define CLI_TEXT_LOG_RECORD_H

#include <jansson.h>
#include <stdint.h>
#include <stdio.h>

#include "enroll/cli/arguments/arguments.h"

/* The sequence number of a record; 0 if it has none. */
uint64_t cli_log_sequence(const json_t *record);

/* The time at which a record was written, in seconds since 1970; 0 if it has none. */
int64_t cli_log_time_s(const json_t *record);

/* Whether the arguments select only some of the records: by people, events or a day. */
bool cli_log_chooses(const struct cli_arguments *arguments);

/* Whether the arguments select the record by its people, its day and its event. Names are compared
 * as the daemon does it (enroll/cli/text/name.h). A rename belongs to the old and the new name. */
bool cli_log_matches(const json_t *record, const struct cli_arguments *arguments);

/* Prints "17 2026-11-21 09:30:15 visit verdict=allow person=anna score=4.12 ...", in local time.
 * Scores have two digits. With `full` they have every digit, and the members for programs are
 * printed, too. */
void cli_log_print_text(const json_t *record, bool full, FILE *out);

/* Prints a line of values separated by commas (RFC 4180, but with a line feed as the line end). */
void cli_log_print_csv(const json_t *record, bool full, FILE *out);

/* Prints the line with the names of these values. */
void cli_log_print_csv_head(bool full, FILE *out);

#endif
