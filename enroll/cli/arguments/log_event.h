/* The events of the audit log, for `isotherm log --event`. */
#ifndef CLI_ARGUMENTS_LOG_EVENT_H
#define CLI_ARGUMENTS_LOG_EVENT_H

#include <stddef.h>

#include "enroll/cli/client/fault.h"

/* The events that the daemon records, one by one from index 0 on, and then NULL. `context` is not
 * used; it makes this an iso_words_fn. */
const char *cli_log_event(size_t index, const void *context);

/* Whether every word of a list, "visit,door", is such an event; NULL is no list and fine.
 * CLI_EXIT_USAGE "usage" names the first that is not, and the event that may be meant. */
enum cli_exit cli_log_events_check(const char *list, struct cli_fault *fault)
    __attribute__((warn_unused_result));

#endif
