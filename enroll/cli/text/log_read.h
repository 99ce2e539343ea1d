/* Records of the audit log, fetched from the daemon in batches. */
#ifndef CLI_TEXT_LOG_READ_H
#define CLI_TEXT_LOG_READ_H

#include <jansson.h>
#include <stdint.h>

#include "enroll/cli/arguments/arguments.h"
#include "enroll/cli/client/daemon.h"

/* The most records of one answer (firmware/contract/contract.h). */
enum { CLI_LOG_BATCH = 1000 };

/* Appends the records that match `arguments` (enroll/cli/text/log_record.h) to `records`: `count`
 * at most of those from number *from on, or with *from 0 the last `count`. *from is then the number
 * of the next record. Records that are written meanwhile are not included: at a busy door this
 * would not end. CLI_EXIT_NOT_FOUND "no-such-record": the log ends before *from.
 * Faults of cli_daemon_send(), "bad-reply". */
enum cli_exit cli_log_read(struct cli_daemon *daemon, const struct cli_arguments *arguments,
                           size_t count, uint64_t *from, json_t *records, struct cli_fault *fault)
    __attribute__((warn_unused_result));

/* The same for the records from number *from on that exist now, one batch at most. */
enum cli_exit cli_log_read_new(struct cli_daemon *daemon, const struct cli_arguments *arguments,
                               uint64_t *from, json_t *records, struct cli_fault *fault)
    __attribute__((warn_unused_result));

#endif
