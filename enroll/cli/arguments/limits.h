/* The limits of a person's validity, as options of a call and as a sentence. */
#ifndef CLI_ARGUMENTS_LIMITS_H
#define CLI_ARGUMENTS_LIMITS_H

#include <systemd/sd-bus.h>

#include "enroll/cli/arguments/arguments.h"
#include "enroll/cli/arguments/when.h"

/* Appends the limits that the command line names, as {sv} within an open array. Returns 0 or more,
 * or a negative errno. */
int cli_limits_append(sd_bus_message *call, const struct cli_arguments *arguments);

enum { CLI_LIMITS_SIZE = 2 * CLI_WHEN_SIZE + 32 };

/* Writes "at all times", "from 2026-12-01 00:00", "until ..." or "from ... until ..."; 0 is no
 * limit. */
void cli_limits_format(int64_t from_s, int64_t until_s, char text[CLI_LIMITS_SIZE]);

#endif
