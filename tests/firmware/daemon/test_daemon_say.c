/* The daemon's lines for the system's journal have a priority, and the daemon does not wait for the
 * journal. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <syslog.h>
#include <unistd.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "firmware/daemon/daemon.h"

/* A journal at the other end of the standard error stream. */
struct journal {
    int end, saved_stderr;
};

static struct journal open_journal(void)
{
    int pair[2];
    struct journal journal;
    assert_int_equal(socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, pair), 0);
    journal.end = pair[1];
    journal.saved_stderr = dup(STDERR_FILENO);
    assert_true(journal.saved_stderr >= 0 && dup2(pair[0], STDERR_FILENO) == STDERR_FILENO);
    assert_int_equal(close(pair[0]), 0);
    assert_int_equal(setenv("JOURNAL_STREAM", "8:1", 1), 0);
    return journal;
}

static void close_journal(const struct journal *journal)
{
    assert_int_equal(dup2(journal->saved_stderr, STDERR_FILENO), STDERR_FILENO);
    assert_int_equal(close(journal->saved_stderr), 0);
    assert_int_equal(close(journal->end), 0);
    assert_int_equal(unsetenv("JOURNAL_STREAM"), 0);
}

static void a_line_bears_its_priority(void **state)
{
    (void)state;
    char line[64] = "";
    const struct journal journal = open_journal();
    iso_daemon_say(LOG_WARNING, "the bus is gone");
    const ssize_t n = recv(journal.end, line, sizeof line - 1, MSG_DONTWAIT);
    close_journal(&journal);
    assert_true(n > 0);
    assert_string_equal(line, "<4>the bus is gone\n");
}

static void a_long_text_is_cut_at_the_end_of_a_line(void **state)
{
    (void)state;
    static char text[3000], line[4000];
    memset(text, 'a', sizeof text - 1);
    const struct journal journal = open_journal();
    iso_daemon_say(LOG_INFO, text);
    const ssize_t n = recv(journal.end, line, sizeof line - 1, MSG_DONTWAIT);
    close_journal(&journal);
    assert_true(n > 1000 && n < 3000);
    assert_memory_equal(line, "<6>aaaa", 7);
    assert_int_equal(line[n - 1], '\n');
}

/* The journal does not read. Without MSG_DONTWAIT the last call would not return. */
static void a_stuck_journal_does_not_stop_the_daemon(void **state)
{
    (void)state;
    char filling[4096] = "";
    const struct journal journal = open_journal();
    while (send(STDERR_FILENO, filling, sizeof filling, MSG_DONTWAIT) > 0) {
    }
    const int full = errno;
    (void)alarm(20);
    iso_daemon_say(LOG_ERR, "nobody reads this");
    (void)alarm(0);
    close_journal(&journal);
    assert_int_equal(full, EAGAIN);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_line_bears_its_priority),
        cmocka_unit_test(a_long_text_is_cut_at_the_end_of_a_line),
        cmocka_unit_test(a_stuck_journal_does_not_stop_the_daemon),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
