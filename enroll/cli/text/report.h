/* The output of the commands: results on stdout (one JSON document with --json), faults on stderr,
 * or with --json as a document {"error": {"code", "message", "exit_code"}} on stdout. */
#ifndef CLI_TEXT_REPORT_H
#define CLI_TEXT_REPORT_H

#include <jansson.h>
#include <stdbool.h>

#include "enroll/cli/client/fault.h"

/* Prints the document on stdout and releases it. CLI_EXIT_FAULT, with a line on stderr, if it is
 * NULL or if there is no memory. main() checks whether all output was written. */
enum cli_exit cli_report_json(json_t *document);

/* The text as a value of a document; null for "". NULL if there is no memory. */
json_t *cli_report_text(const char *text);

/* Prints a fault: its text on stderr, or with `json` a document on stdout. */
void cli_report_fault(const struct cli_fault *fault, enum cli_exit exit, bool json);

#endif
