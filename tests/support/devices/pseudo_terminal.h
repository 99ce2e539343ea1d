/* A terminal without a screen: a program or a function writes to it, the test reads what came. */
#ifndef TEST_PSEUDO_TERMINAL_H
#define TEST_PSEUDO_TERMINAL_H

#include <stddef.h>
#include <stdio.h>
#include <sys/types.h>

struct pseudo_terminal {
    int master_fd;
    FILE *slave; /* to write to; NULL once it is closed */
};

/* Opens one of so many columns. */
void pseudo_terminal_open(struct pseudo_terminal *terminal, unsigned short columns);

/* What has been written to it since the last call, as text, with "\r\n" for each line end as the
 * kernel makes them. Does not wait. */
void pseudo_terminal_read(struct pseudo_terminal *terminal, char *text, size_t size);

void pseudo_terminal_close(struct pseudo_terminal *terminal);

/* Runs a program with a terminal of so many columns as its standard output and error and returns
 * what it printed there, to be freed by the caller. *status is that of waitpid(). `environment` is
 * one NAME=VALUE that is added, or NULL. */
char *pseudo_terminal_run(const char *const argv[], unsigned short columns, const char *environment,
                          int *status);

#endif
