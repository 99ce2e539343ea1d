/* Runs another program to its end and keeps what it prints. */
#ifndef CLI_MACHINE_CHILD_H
#define CLI_MACHINE_CHILD_H

#include <stddef.h>

#include "enroll/cli/client/fault.h"

struct cli_child {
    int exit;  /* the exit code, or 128 + the number of the signal that ended it */
    char *out; /* standard output; the caller frees it */
    char *err; /* standard error; the caller frees it */
};

/* Runs argv[0], a path, with empty standard input. The first 256 KiB of each stream are kept.
 * CLI_EXIT_FAULT if the program cannot be run or has not ended after 30 seconds.
 * CLI_EXIT_INTERRUPTED after an interrupt (interrupt.h). In the last two cases it is killed. */
enum cli_exit cli_child_run(const char *const argv[], struct cli_child *out,
                            struct cli_fault *fault) __attribute__((warn_unused_result));

/* The same, with the file `in_fd` as standard input (-1: empty), and the first kept_bytes - 1 of
 * each stream are kept. */
enum cli_exit cli_child_feed(const char *const argv[], int in_fd, size_t kept_bytes,
                             struct cli_child *out, struct cli_fault *fault)
    __attribute__((warn_unused_result));

/* Frees the texts. An all-zero child is accepted. */
void cli_child_done(struct cli_child *child);

#endif
