/* Records of the audit log, fetched from the daemon in batches. */
#ifndef CLI_TEXT_LOG_READ_H
#define CLI_TEXT_LOG_READ_H

#include <jansson.h>
#include <stdint.h>

#include "enroll/cli/arguments/arguments.h"
#include "enroll/cli/client/daemon.h"

/* What the daemon hands out at once (firmware/contract/contract.h). */
enum { CLI_LOG_BATCH = 1000 };

/* Appends the records that match `arguments` (enroll/cli/text/log_record.h) to `records`: `count`
 * at most of those from number *from on, or with *from 0 the last `count`. *from is then the number
 * of the record that comes next. What is written meanwhile is not waited for: at a busy door that
 * would have no end. CLI_EXIT_NOT_FOUND "no-such-record": the log does not go as far as *from.
 * Faults of cli_daemon_send(), "bad-reply". */
enum cli_exit cli_log_read(struct cli_daemon *daemon, const struct cli_arguments *arguments,
                           size_t count, uint64_t *from, json_t *records, struct cli_fault *fault)
    __attribute__((warn_unused_result));

/* Likewise those from number *from on that there are by now, a batch at most. */
enum cli_exit cli_log_read_new(struct cli_daemon *daemon, const struct cli_arguments *arguments,
                               uint64_t *from, json_t *records, struct cli_fault *fault)
    __attribute__((warn_unused_result));

#endif
