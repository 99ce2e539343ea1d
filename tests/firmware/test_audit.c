/* The audit log. */
#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/firmware/cmocka_headers.h"

#include "firmware/audit.h"
#include "tests/support/manual_clock.h"
#include "tests/support/scratch.h"

static int64_t now_ns = 81250000000;
static int64_t wall_ns = INT64_C(1795250000250000000); /* 2026-11-21T08:33:20.250Z */

static struct iso_times times(void)
{
    return (struct iso_times){manual_clock(&now_ns), manual_clock_now_ns, &wall_ns};
}

static struct iso_times the_times;

static int setup(void **state)
{
    the_times = times();
    return scratch_setup(state);
}

static int try_open(const char *directory, struct iso_audit **out, struct iso_fault *fault)
{
    return iso_audit_open(scratch_path(directory, "a.log"), true, &the_times, out, fault);
}

static struct iso_audit *open_log(const char *directory)
{
    struct iso_audit *audit = NULL;
    struct iso_fault fault = {""};
    if (try_open(directory, &audit, &fault)) {
        fail_msg("%s", fault.text);
    }
    return audit;
}

static int append(struct iso_audit *audit, const char *event, struct iso_fault *fault)
{
    const struct iso_audit_record record = iso_audit_record_of(event);
    return iso_audit_append(audit, &record, fault);
}

static char *whole_log(const char *directory)
{
    size_t size = 0;
    char *text = scratch_read(scratch_path(directory, "a.log"), &size);
    text[size] = '\0';
    return text;
}

/* ---- writing ---- */

static void writes_records(void **state)
{
    struct iso_audit *audit = open_log(*state);
    struct iso_audit_record record = iso_audit_record_of("visit");
    record.person = "an\"na";
    record.verdict = "allow";
    record.reason = "match";
    record.score = 7.25;
    record.threshold = 4;
    record.frames = 2;
    assert_int_equal(append(audit, "start", NULL), 0);
    assert_int_equal(iso_audit_append(audit, &record, NULL), 0);
    assert_int_equal(iso_audit_last(audit), 2);
    iso_audit_close(audit);
    char *text = whole_log(*state);
    assert_string_equal(text, "{\"sequence\":1,\"time\":\"2026-11-21T08:33:20.250Z\","
                              "\"monotonic_ns\":81250000000,\"event\":\"start\"}\n"
                              "{\"sequence\":2,\"time\":\"2026-11-21T08:33:20.250Z\","
                              "\"monotonic_ns\":81250000000,\"event\":\"visit\","
                              "\"person\":\"an\\\"na\",\"verdict\":\"allow\",\"reason\":\"match\","
                              "\"score\":7.25,\"threshold\":4,\"frames\":2}\n");
    free(text);
}

static void goes_on_counting(void **state)
{
    struct iso_audit *audit = open_log(*state);
    assert_int_equal(append(audit, "one", NULL), 0);
    assert_int_equal(append(audit, "two", NULL), 0);
    iso_audit_close(audit);
    audit = open_log(*state);
    assert_int_equal(iso_audit_last(audit), 2);
    assert_int_equal(append(audit, "three", NULL), 0);
    assert_int_equal(iso_audit_last(audit), 3);
    iso_audit_close(audit);
    iso_audit_close(open_log(*state));
    iso_audit_close(NULL);
}

static void refuses_a_record_that_is_too_long(void **state)
{
    struct iso_audit *audit = open_log(*state);
    struct iso_fault fault = {""};
    struct iso_audit_record record = iso_audit_record_of("x");
    char note[4000];
    memset(note, 'n', sizeof note - 1);
    note[sizeof note - 1] = '\0';
    record.note = note;
    assert_int_equal(iso_audit_append(audit, &record, &fault), -EINVAL);
    assert_non_null(strstr(fault.text, "the record is too long"));
    assert_int_equal(append(audit, "next", NULL), 0);
    assert_int_equal(iso_audit_last(audit), 1);
    iso_audit_close(audit);
}

/* ---- reading ---- */

struct seen {
    unsigned n, first, last;
    int stop_at; /* the result of the call for this one is 7 */
};

static int see(void *context, const char *line)
{
    struct seen *seen = context;
    unsigned sequence = 0;
    assert_int_equal(sscanf(line, "{\"sequence\":%u,", &sequence), 1);
    assert_null(strchr(line, '\n'));
    if (seen->n++ == 0) {
        seen->first = sequence;
    } else {
        assert_int_equal(sequence, seen->last + 1);
    }
    seen->last = sequence;
    return (int)sequence == seen->stop_at ? 7 : 0;
}

static void expect_reading(struct iso_audit *audit, uint64_t from, uint32_t max, unsigned n,
                           unsigned first, unsigned last)
{
    struct seen seen = {0};
    assert_int_equal(iso_audit_read(audit, from, max, see, &seen), 0);
    assert_int_equal(seen.n, n);
    assert_int_equal(seen.first, first);
    assert_int_equal(seen.last, last);
}

/* Over the places that are remembered, written and found at open. */
static void reads_from_anywhere(void **state)
{
    struct iso_audit *audit = NULL;
    struct seen seen = {.stop_at = 300};
    assert_int_equal(iso_audit_open(scratch_path(*state, "a.log"), false, &the_times, &audit, NULL),
                     0);
    for (int i = 0; i < 700; i++) {
        assert_int_equal(append(audit, "x", NULL), 0);
    }
    for (int again = 0; again < 2; again++) {
        expect_reading(audit, 1, 700, 700, 1, 700);
        expect_reading(audit, 0, 3, 3, 1, 3);
        expect_reading(audit, 256, 3, 3, 256, 258);
        expect_reading(audit, 257, 1, 1, 257, 257);
        expect_reading(audit, 690, 100, 11, 690, 700);
        expect_reading(audit, 700, UINT32_MAX, 1, 700, 700);
        expect_reading(audit, 701, 5, 0, 0, 0);
        expect_reading(audit, 5, 0, 0, 0, 0);
        iso_audit_close(audit);
        audit = open_log(*state);
    }
    assert_int_equal(iso_audit_read(audit, 298, 100, see, &seen), 7);
    assert_int_equal(seen.last, 300);
    iso_audit_close(audit);
}

/* ---- damage ---- */

static void takes_a_torn_line_away(void **state)
{
    struct iso_audit *audit = open_log(*state);
    assert_int_equal(append(audit, "one", NULL), 0);
    assert_int_equal(append(audit, "two", NULL), 0);
    iso_audit_close(audit);
    char *whole = whole_log(*state);
    const size_t first = strcspn(whole, "\n") + 1;
    for (size_t length = first + 1; length < strlen(whole); length++) {
        char note[64];
        scratch_write(scratch_path(*state, "a.log"), whole, length);
        audit = open_log(*state);
        assert_int_equal(iso_audit_last(audit), 2);
        iso_audit_close(audit);
        char *text = whole_log(*state);
        (void)snprintf(note, sizeof note,
                       "\"note\":\"%zu bytes of an unfinished record taken away\"}",
                       length - first);
        assert_memory_equal(text, whole, first);
        assert_non_null(strstr(text + first, "{\"sequence\":2,"));
        assert_non_null(strstr(text + first, "\"event\":\"log-recovered\""));
        assert_non_null(strstr(text + first, note));
        free(text);
    }
    free(whole);
}

static void expect_refusal(const char *directory, const char *text, const char *message)
{
    struct iso_audit *audit = NULL;
    struct iso_fault fault = {""};
    scratch_write_text(scratch_path(directory, "a.log"), text);
    assert_int_equal(try_open(directory, &audit, &fault), -EBADMSG);
    if (!strstr(fault.text, message)) {
        fail_msg("'%s' does not say '%s'", fault.text, message);
    }
    char *after = whole_log(directory);
    assert_string_equal(after, text);
    free(after);
}

static void refuses_a_log_that_was_changed(void **state)
{
    expect_refusal(*state, "{\"sequence\":1,\"x\":0}\n{\"sequence\":3,\"x\":0}\n",
                   "/a.log:2: damaged, or not record 2; move the file away to begin a new log");
    expect_refusal(*state, "{\"sequence\":1,\"x\":0}\n{\"sequence\":1,\"x\":0}\n",
                   "/a.log:2: damaged");
    expect_refusal(*state, "{\"sequence\":2,\"x\":0}\n", "/a.log:1: damaged");
    expect_refusal(*state, "{\"sequence\":1,\"x\":0\n", "/a.log:1: damaged");
    expect_refusal(*state, "hello\n", "/a.log:1: damaged");
    expect_refusal(*state, "\n", "/a.log:1: damaged");
}

static void refuses_where_it_cannot_write(void **state)
{
    struct iso_audit *audit = open_log(*state), *second = NULL;
    struct iso_fault fault = {""};
    assert_int_equal(try_open(*state, &second, &fault), -EBUSY);
    assert_non_null(strstr(fault.text, "/a.log: another process writes it"));
    iso_audit_close(audit);
    assert_int_equal(iso_audit_open("/nonexistent/a.log", true, &the_times, &second, &fault),
                     -ENOENT);
    assert_string_equal(fault.text, "/nonexistent/a.log: No such file or directory");
    assert_int_equal(iso_audit_open(*state, true, &the_times, &second, &fault), -EISDIR);
}

/* ---- a full disk ---- */

static int fill_up(const char *directory)
{
    const struct rlimit limit = {1000, 5000};
    const struct rlimit more = {5000, 5000};
    struct iso_fault fault = {""};
    struct iso_audit *audit = open_log(directory);
    if (signal(SIGXFSZ, SIG_IGN) == SIG_ERR || setrlimit(RLIMIT_FSIZE, &limit)) {
        return 99;
    }
    int n = 0, error;
    while ((error = append(audit, "filling", &fault)) == 0) {
        n++;
    }
    if (error != -ENOSPC || !strstr(fault.text, "cannot be written: No space left on device")) {
        return 98;
    }
    if (iso_audit_last(audit) != (uint64_t)n || append(audit, "filling", NULL) != -ENOSPC) {
        return 97;
    }
    /* Room again: it goes on where it was. */
    if (setrlimit(RLIMIT_FSIZE, &more) || append(audit, "again", NULL)) {
        return 96;
    }
    return n;
}

static void expect_one_record_a_line(const char *directory)
{
    char *text = whole_log(directory);
    for (char *line = text; *line; line += strcspn(line, "\n") + 1) {
        const size_t length = strcspn(line, "\n");
        assert_null(memchr(line + 1, '{', length - 1)); /* no part of another one in it */
    }
    free(text);
}

static void a_full_disk_leaves_whole_lines(void **state)
{
    int status = 0;
    const pid_t pid = fork();
    assert_true(pid >= 0);
    if (pid == 0) {
        _exit(fill_up(*state));
    }
    assert_int_equal(waitpid(pid, &status, 0), pid);
    assert_true(WIFEXITED(status));
    const int n = WEXITSTATUS(status);
    assert_in_range(n, 5, 12);
    struct iso_audit *audit = open_log(*state); /* it refuses a log with a gap */
    assert_int_equal(iso_audit_last(audit), n + 1);
    iso_audit_close(audit);
    expect_one_record_a_line(*state);
}

/* Killed while it writes, it loses at most the record that was not reported. */
static void survives_kills(void **state)
{
    for (int round = 0; round < 20; round++) {
        int fds[2], reported = 0;
        char byte;
        (void)unlink(scratch_path(*state, "a.log"));
        assert_int_equal(pipe(fds), 0);
        const pid_t pid = fork();
        assert_true(pid >= 0);
        if (pid == 0) {
            struct iso_audit *audit = open_log(*state);
            while (append(audit, "x", NULL) == 0 && write(fds[1], "+", 1) == 1) {
            }
            _exit(1);
        }
        (void)close(fds[1]);
        while (reported < 5 + round && read(fds[0], &byte, 1) == 1) {
            reported++;
        }
        assert_int_equal(kill(pid, SIGKILL), 0);
        assert_int_equal(waitpid(pid, NULL, 0), pid);
        while (read(fds[0], &byte, 1) == 1) {
            reported++;
        }
        (void)close(fds[0]);
        struct iso_audit *audit = open_log(*state);
        assert_in_range(iso_audit_last(audit), reported, reported + 1);
        iso_audit_close(audit);
    }
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, setup, scratch_teardown)
    const struct CMUnitTest tests[] = {
        TEST(writes_records),
        TEST(goes_on_counting),
        TEST(refuses_a_record_that_is_too_long),
        TEST(reads_from_anywhere),
        TEST(takes_a_torn_line_away),
        TEST(refuses_a_log_that_was_changed),
        TEST(refuses_where_it_cannot_write),
        TEST(a_full_disk_leaves_whole_lines),
        TEST(survives_kills),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
