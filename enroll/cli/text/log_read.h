/* Records of the audit log, fetched from the daemon in batches. */
#ifndef CLI_TEXT_LOG_READ_H
#define CLI_TEXT_LOG_READ_H

#include <jansson.h>
#include <stdint.h>

#include "enroll/cli/arguments/arguments.h"
#include "enroll/cli/client/daemon.h"

/* The most records of one answer (firmware/contract/contract.h). */
enum { CLI_LOG_BATCH = 1000 };

/* Appends at most `count` records that match `arguments` (enroll/cli/text/log_record.h) to
 * `records`: the first ones from number *from on, or the last ones of the log if *from is 0. Then
 * *from is the number of the record to read next. Records that are written during the call are not
 * included, because at a busy door it would not end. CLI_EXIT_NOT_FOUND "no-such-record" if the log
 * ends before *from. Other faults are those of cli_daemon_send() and "bad-reply". */
enum cli_exit cli_log_read(struct cli_daemon *daemon, const struct cli_arguments *arguments,
                           size_t count, uint64_t *from, json_t *records, struct cli_fault *fault)
    __attribute__((warn_unused_result));

/* Appends the matching records among those that now exist from number *from on, from one batch at
 * most. *from and the faults are as for cli_log_read(). */
enum cli_exit cli_log_read_new(struct cli_daemon *daemon, const struct cli_arguments *arguments,
                               uint64_t *from, json_t *records, struct cli_fault *fault)
    __attribute__((warn_unused_result));

#endif
