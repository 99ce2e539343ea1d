/* How a child process ended, in words: what was run, its exit code or signal, and the last line
 * that it printed. Tests assert the end of a child by these and not by comparing numbers. */
#ifndef TEST_CHILD_END_H
#define TEST_CHILD_END_H

#include <sys/types.h>

/* The code of an end: the exit code, or 1000 + the signal. `status` is that of waitpid() or
 * system(). */
int child_code(int status);

/* Fails the test unless the code is `expected`: "WHAT: ended with exit code 3, not exit code 0;
 * last it said: ...". `out` and `err` are what the child printed (NULL: not known); the last line
 * of `err` counts, or if there is none that of `out`. */
void child_expect_code(const char *what, int code, int expected, const char *out, const char *err);

/* A forked child whose standard error is caught. */
struct child {
    pid_t pid;
    int err_fd;
    const char *what; /* kept, not copied */
};

/* As fork(): 0 in the child. That fork() fails fails the test. */
pid_t child_fork(struct child *child, const char *what);

/* Waits for the child's end and returns its code; what it printed on standard error is in `err`,
 * cut to fit. */
enum { CHILD_ERR_SIZE = 4096 };
int child_wait(struct child *child, char err[CHILD_ERR_SIZE]);

/* Waits, and fails the test unless the child has ended with this exit code. */
void child_expect(struct child *child, int expected);

#endif
