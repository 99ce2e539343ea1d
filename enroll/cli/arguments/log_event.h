/* The events of the audit log, for `isotherm log --event`. */
#ifndef CLI_ARGUMENTS_LOG_EVENT_H
#define CLI_ARGUMENTS_LOG_EVENT_H

#include <stddef.h>

#include "enroll/cli/client/fault.h"

/* The name of an event that the daemon records, by its index; NULL after the last one. `context` is
 * not used; with it this function is an iso_words_fn. */
const char *cli_log_event(size_t index, const void *context);

/* Checks that every word of a list such as "visit,door" is an event. NULL, for no list, is
 * accepted. CLI_EXIT_USAGE "usage" if a word is not: the fault names it, and the event that may be
 * meant. */
enum cli_exit cli_log_events_check(const char *list, struct cli_fault *fault)
    __attribute__((warn_unused_result));

#endif
