#include "tests/support/programs/run.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/support/child_end.h"

enum { SILENCE_MS = 60 * 1000 };

void run_start(struct run *run, const char *const argv[])
{
    run_start_to(run, argv, NULL);
}

void run_start_to(struct run *run, const char *const argv[], const char *out_path)
{
    int out[2], err[2];

    *run = (struct run){.out = calloc(1, RUN_OUTPUT_SIZE), .err = calloc(1, RUN_OUTPUT_SIZE)};
    for (size_t i = 0; argv[i]; i++) {
        const size_t length = strlen(run->what);
        (void)snprintf(run->what + length, sizeof run->what - length, "%s%s", i ? " " : "",
                       argv[i]);
    }
    assert_non_null(run->out);
    assert_non_null(run->err);
    assert_int_equal(pipe(out), 0);
    assert_int_equal(pipe(err), 0);
    run->pid = fork();
    assert_true(run->pid >= 0);
    if (run->pid == 0) {
        prctl(PR_SET_PDEATHSIG, SIGKILL);
        dup2(out_path ? open(out_path, O_WRONLY | O_CLOEXEC) : out[1], STDOUT_FILENO);
        dup2(err[1], STDERR_FILENO);
        close(out[0]), close(out[1]), close(err[0]), close(err[1]);
        execv(argv[0], (char *const *)(uintptr_t)argv);
        _exit(126);
    }
    close(out[1]);
    close(err[1]);
    run->out_fd = out[0];
    run->err_fd = err[0];
}

static void take(int *fd, char *text, size_t *size)
{
    const ssize_t n = read(*fd, text + *size, RUN_OUTPUT_SIZE - 1 - *size);

    if (n <= 0) {
        assert_true(*size < RUN_OUTPUT_SIZE - 1);
        close(*fd);
        *fd = -1;
        return;
    }
    *size += (size_t)n;
    text[*size] = '\0';
}

/* Reads the next output of either stream. */
static void pump(struct run *run)
{
    struct pollfd fds[2] = {
        {.fd = run->out_fd, .events = POLLIN},
        {.fd = run->err_fd, .events = POLLIN},
    };

    if (poll(fds, 2, SILENCE_MS) <= 0) {
        kill(run->pid, SIGKILL);
        fail_msg("the program hangs; it said: %s%s", run->out, run->err);
    }
    if (fds[0].revents) {
        take(&run->out_fd, run->out, &run->out_size);
    }
    if (fds[1].revents) {
        take(&run->err_fd, run->err, &run->err_size);
    }
}

void run_until(struct run *run, const char *text)
{
    while (!strstr(run->out, text) && !strstr(run->err, text)) {
        if (run->out_fd < 0 && run->err_fd < 0) {
            fail_msg("'%s' never came; but: %s%s", text, run->out, run->err);
        }
        pump(run);
    }
}

void run_finish(struct run *run)
{
    int status;

    while (run->out_fd >= 0 || run->err_fd >= 0) {
        pump(run);
    }
    assert_int_equal(waitpid(run->pid, &status, 0), run->pid);
    run->pid = 0;
    run->exit = child_code(status);
}

void run_expect(const struct run *run, int exit)
{
    child_expect_code(run->what, run->exit, exit, run->out, run->err);
}

void run_free(struct run *run)
{
    free(run->out);
    free(run->err);
    run->out = NULL;
    run->err = NULL;
}
