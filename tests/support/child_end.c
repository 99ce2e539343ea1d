#include "tests/support/child_end.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <stdio.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

enum { SIGNAL_CODE = 1000, END_SIZE = 64, LINE_SIZE = 512 };

int child_code(int status)
{
    return WIFSIGNALED(status) ? SIGNAL_CODE + WTERMSIG(status) : WEXITSTATUS(status);
}

static void describe(int code, char text[END_SIZE])
{
    if (code >= SIGNAL_CODE) {
        (void)snprintf(text, END_SIZE, "signal %d (%s)", code - SIGNAL_CODE,
                       strsignal(code - SIGNAL_CODE));
    } else {
        (void)snprintf(text, END_SIZE, "exit code %d", code);
    }
}

/* The last line that is not empty; "" if there is none. */
static void find_last_line(const char *text, char line[LINE_SIZE])
{
    line[0] = '\0';
    while (text && *text) {
        const size_t length = strcspn(text, "\n");
        if (length > 0) {
            (void)snprintf(line, LINE_SIZE, "%.*s", (int)length, text);
        }
        text += length + (text[length] == '\n');
    }
}

void child_expect_code(const char *what, int code, int expected, const char *out, const char *err)
{
    char end[END_SIZE], wanted[END_SIZE], line[LINE_SIZE];

    if (code == expected) {
        return;
    }
    describe(code, end);
    describe(expected, wanted);
    find_last_line(err, line);
    if (!line[0]) {
        find_last_line(out, line);
    }
    fail_msg("%s: ended with %s, not %s; %s%s", what, end, wanted,
             line[0] ? "last it said: " : "it said nothing", line);
}

pid_t child_fork(struct child *child, const char *what)
{
    int fds[2];

    fflush(NULL);
    assert_int_equal(pipe(fds), 0);
    *child = (struct child){.what = what, .err_fd = fds[0], .pid = fork()};
    assert_true(child->pid >= 0);
    if (child->pid == 0) {
        (void)dup2(fds[1], STDERR_FILENO);
        (void)close(fds[0]);
    }
    (void)close(fds[1]);
    return child->pid;
}

int child_wait(struct child *child, char err[CHILD_ERR_SIZE])
{
    char byte;
    size_t length = 0;
    int status = 0;

    while (read(child->err_fd, &byte, 1) == 1) {
        if (length == CHILD_ERR_SIZE - 1) { /* keep the end of the output */
            length = CHILD_ERR_SIZE / 2;
            memmove(err, err + CHILD_ERR_SIZE / 2 - 1, length);
        }
        err[length++] = byte;
    }
    err[length] = '\0';
    (void)close(child->err_fd);
    assert_int_equal(waitpid(child->pid, &status, 0), child->pid);
    return child_code(status);
}

void child_expect(struct child *child, int expected)
{
    char err[CHILD_ERR_SIZE];
    const int code = child_wait(child, err);

    fputs(err, stderr);
    child_expect_code(child->what, code, expected, NULL, err);
}
