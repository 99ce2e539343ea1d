#include "tests/support/devices/pseudo_terminal.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <fcntl.h>
#include <pty.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

enum { PRINTED_MAX = 256 * 1024 };

void pseudo_terminal_open(struct pseudo_terminal *terminal, unsigned short columns)
{
    const struct winsize size = {.ws_row = 24, .ws_col = columns};
    int slave_fd;

    assert_int_equal(openpty(&terminal->master_fd, &slave_fd, NULL, NULL, &size), 0);
    assert_int_equal(fcntl(terminal->master_fd, F_SETFL, O_NONBLOCK), 0);
    terminal->slave = fdopen(slave_fd, "w");
    assert_non_null(terminal->slave);
}

void pseudo_terminal_read(struct pseudo_terminal *terminal, char *text, size_t size)
{
    size_t length = 0;
    ssize_t n;

    fflush(terminal->slave);
    while (length < size - 1 &&
           (n = read(terminal->master_fd, text + length, size - 1 - length)) > 0) {
        length += (size_t)n;
    }
    text[length] = '\0';
}

void pseudo_terminal_close(struct pseudo_terminal *terminal)
{
    fclose(terminal->slave);
    close(terminal->master_fd);
}

static void become(const char *const argv[], const char *environment)
{
    (void)prctl(PR_SET_PDEATHSIG, SIGKILL);
    (void)setenv("TERM", "xterm", 1);
    (void)unsetenv("NO_COLOR");
    if (environment) {
        (void)putenv((char *)(uintptr_t)environment);
    }
    execv(argv[0], (char *const *)(uintptr_t)argv);
    _exit(126);
}

char *pseudo_terminal_run(const char *const argv[], unsigned short columns, const char *environment,
                          int *status)
{
    const struct winsize window = {.ws_row = 24, .ws_col = columns};
    char *text = calloc(1, PRINTED_MAX);
    size_t length = 0;
    int master_fd;
    ssize_t n;

    assert_non_null(text);
    const pid_t pid = forkpty(&master_fd, NULL, NULL, &window);
    assert_true(pid >= 0);
    if (pid == 0) {
        become(argv, environment);
    }
    while ((n = read(master_fd, text + length, PRINTED_MAX - 1 - length)) > 0) {
        length += (size_t)n; /* a terminal without a writer ends with EIO */
    }
    close(master_fd);
    assert_int_equal(waitpid(pid, status, 0), pid);
    return text;
}
