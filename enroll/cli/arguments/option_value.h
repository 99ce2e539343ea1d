/* Options of the command line as members of struct cli_arguments. */
#ifndef CLI_ARGUMENTS_OPTION_VALUE_H
#define CLI_ARGUMENTS_OPTION_VALUE_H

#include <stdbool.h>

#include "enroll/cli/arguments/arguments.h"
#include "enroll/cli/arguments/option_table.h"

/* Stores one option. `value` is its text, or NULL for an option that takes none. Returns false if
 * the value is bad. It stores nothing for --json, which cli_arguments_parse has found before, and
 * only the text for --from, whose meaning depends on the command. */
bool cli_option_store(struct cli_arguments *out, enum cli_option_id id, const char *value)
    __attribute__((warn_unused_result));

/* Reads out->from_text, once the command is known: a record's number for log, a point in time for
 * validity. False if it is bad. */
bool cli_option_read_from(struct cli_arguments *out) __attribute__((warn_unused_result));

#endif
