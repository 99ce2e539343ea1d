/* Describes the end of a child process: the command, its exit code or signal, and the last line
 * that it printed. Tests assert the end of a child by these functions and do not compare numbers.
 */
#ifndef TEST_CHILD_END_H
#define TEST_CHILD_END_H

#include <sys/types.h>

/* The code of an end: the exit code, or 1000 + the signal. `status` is that of waitpid() or
 * system(). */
int child_code(int status);

/* Fails the test unless the code is `expected`: "WHAT: ended with exit code 3, not exit code 0;
 * last it said: ...". `out` and `err` are the output of the child (NULL: not known). The message
 * has the last line of `err`, or the last line of `out` if `err` has none. */
void child_expect_code(const char *what, int code, int expected, const char *out, const char *err);

/* A forked child whose standard error is captured. */
struct child {
    pid_t pid;
    int err_fd;
    const char *what; /* kept, not copied */
};

/* As fork(): returns 0 in the child. The test fails if fork() fails. */
pid_t child_fork(struct child *child, const char *what);

/* Waits for the child's end and returns its code. `err` gets the end of what the child printed on
 * standard error. */
enum { CHILD_ERR_SIZE = 4096 };
int child_wait(struct child *child, char err[CHILD_ERR_SIZE]);

/* Waits, and fails the test unless the child has ended with this exit code. */
void child_expect(struct child *child, int expected);

#endif
