/* A terminal without a screen: a program or a function writes to it, and the test reads the text.
 */
#ifndef TEST_PSEUDO_TERMINAL_H
#define TEST_PSEUDO_TERMINAL_H

#include <stddef.h>
#include <stdio.h>
#include <sys/types.h>

struct pseudo_terminal {
    int master_fd;
    FILE *slave; /* to write to; NULL once it is closed */
};

/* Opens a terminal with this number of columns. */
void pseudo_terminal_open(struct pseudo_terminal *terminal, unsigned short columns);

/* Reads the text that was written since the last call, at most size - 1 bytes. Each line ends with
 * "\r\n", as the kernel makes it. Does not wait. */
void pseudo_terminal_read(struct pseudo_terminal *terminal, char *text, size_t size);

void pseudo_terminal_close(struct pseudo_terminal *terminal);

/* Runs a program whose standard output and error are a terminal with this number of columns.
 * Returns the text that it printed, which the caller frees. *status is that of waitpid().
 * `environment` is one NAME=VALUE that is added, or NULL. */
char *pseudo_terminal_run(const char *const argv[], unsigned short columns, const char *environment,
                          int *status);

#endif
