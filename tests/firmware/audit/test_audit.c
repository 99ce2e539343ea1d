/* The audit log. */
#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "tests/firmware/rigs/audit_rig.h"
#include "tests/support/child_end.h"
#include "tests/support/scratch.h"

/* ---- writing ---- */

static void writes_records(void **state)
{
    struct iso_audit *audit = audit_rig_open(*state);
    struct iso_audit_record record = iso_audit_record_of("visit");
    record.person = "an\"na";
    record.verdict = "allow";
    record.reason = "match";
    record.score = 7.25;
    record.threshold = 4;
    record.frames = 2;
    record.sensor = "started";
    record.gallery = "0123456789abcdef";
    record.gallery_changes = 12;
    assert_int_equal(audit_rig_append(audit, "start", NULL), 0);
    assert_int_equal(iso_audit_append(audit, &record, NULL), 0);
    assert_int_equal(iso_audit_last(audit), 2);
    iso_audit_close(audit);
    char *text = audit_rig_log(*state);
    assert_string_equal(text, "{\"sequence\":1,\"time\":\"2026-11-21T08:33:20.250Z\","
                              "\"monotonic_ns\":81250000000,\"event\":\"start\"}\n"
                              "{\"sequence\":2,\"time\":\"2026-11-21T08:33:20.250Z\","
                              "\"monotonic_ns\":81250000000,\"event\":\"visit\","
                              "\"person\":\"an\\\"na\",\"verdict\":\"allow\",\"reason\":\"match\","
                              "\"score\":7.25,\"threshold\":4,\"frames\":2,"
                              "\"sensor\":\"started\","
                              "\"gallery\":\"0123456789abcdef:12\"}\n");
    free(text);
}

static void goes_on_counting(void **state)
{
    struct iso_audit *audit = audit_rig_open(*state);
    assert_int_equal(audit_rig_append(audit, "one", NULL), 0);
    assert_int_equal(audit_rig_append(audit, "two", NULL), 0);
    iso_audit_close(audit);
    audit = audit_rig_open(*state);
    assert_int_equal(iso_audit_last(audit), 2);
    assert_int_equal(audit_rig_append(audit, "three", NULL), 0);
    assert_int_equal(iso_audit_last(audit), 3);
    iso_audit_close(audit);
    iso_audit_close(audit_rig_open(*state));
    iso_audit_close(NULL);
}

static void refuses_a_record_that_is_too_long(void **state)
{
    struct iso_audit *audit = audit_rig_open(*state);
    struct iso_fault fault = {.text = ""};
    struct iso_audit_record record = iso_audit_record_of("x");
    char note[4000];
    memset(note, 'n', sizeof note - 1);
    note[sizeof note - 1] = '\0';
    record.note = note;
    assert_int_equal(iso_audit_append(audit, &record, &fault), -EINVAL);
    assert_non_null(strstr(fault.text, "the record is too long"));
    assert_int_equal(audit_rig_append(audit, "next", NULL), 0);
    assert_int_equal(iso_audit_last(audit), 1);
    iso_audit_close(audit);
}

/* ---- reading ---- */

static void expect_reading(struct iso_audit *audit, uint64_t from, uint32_t max, unsigned n,
                           unsigned first, unsigned last)
{
    struct audit_rig_seen seen = {0};
    assert_int_equal(iso_audit_read(audit, from, max, audit_rig_see, &seen), 0);
    assert_int_equal(seen.n, n);
    assert_int_equal(seen.first, first);
    assert_int_equal(seen.last, last);
}

/* Reads over the remembered positions, which are noted while the log is written and when it is
 * opened. */
static void reads_from_anywhere(void **state)
{
    struct iso_audit *audit = NULL;
    struct audit_rig_seen seen = {.stop_at = 300};
    struct iso_audit_options options = stores_audit(*state);
    options.sync = false;
    assert_int_equal(iso_audit_open(&options, &audit_rig_times, &audit, NULL), 0);
    for (int i = 0; i < 700; i++) {
        assert_int_equal(audit_rig_append(audit, "x", NULL), 0);
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
        audit = audit_rig_open(*state);
    }
    assert_int_equal(iso_audit_read(audit, 298, 100, audit_rig_see, &seen), 7);
    assert_int_equal(seen.last, 300);
    iso_audit_close(audit);
}

/* ---- where the log cannot be opened ---- */

static void refuses_where_it_cannot_write(void **state)
{
    struct iso_audit *audit = audit_rig_open(*state), *second = NULL;
    struct iso_fault fault = {.text = ""};
    assert_int_equal(audit_rig_try_open(*state, &second, &fault), -EBUSY);
    assert_non_null(strstr(fault.text, "/a.log: another process writes it"));
    iso_audit_close(audit);
    struct iso_audit_options options = stores_audit(*state);
    options.path = "/nonexistent/a.log";
    assert_int_equal(iso_audit_open(&options, &audit_rig_times, &second, &fault), -ENOENT);
    assert_string_equal(fault.text, "/nonexistent/a.log: No such file or directory");
    options.path = *state;
    assert_int_equal(iso_audit_open(&options, &audit_rig_times, &second, &fault), -EISDIR);
}

/* ---- a full disk ---- */

static int fill_up(const char *directory)
{
    const struct rlimit limit = {6000, 9000};
    const struct rlimit more = {9000, 9000};
    struct iso_fault fault = {.text = ""};
    struct iso_audit *audit = audit_rig_open(directory);
    if (signal(SIGXFSZ, SIG_IGN) == SIG_ERR || setrlimit(RLIMIT_FSIZE, &limit)) {
        return 99;
    }
    int n = 0, error;
    while ((error = audit_rig_append(audit, "filling", &fault)) == 0) {
        n++;
    }
    if (error != -ENOSPC || !strstr(fault.text, "the disk refused: No space left on device")) {
        return 98;
    }
    if (iso_audit_last(audit) != (uint64_t)n ||
        audit_rig_append(audit, "filling", NULL) != -ENOSPC) {
        return 97;
    }
    /* There is room again. The log continues after its last record. */
    if (setrlimit(RLIMIT_FSIZE, &more) || audit_rig_append(audit, "again", NULL)) {
        return 96;
    }
    return n;
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
    const int n = child_code(status);
    if (n < 15 || n > 40) {
        fail_msg("on a full disk: the exit code is %d, not a number of records from 15 to 40", n);
    }
    struct iso_audit *audit = audit_rig_open(*state); /* the open fails if the log has a gap */
    assert_int_equal(iso_audit_last(audit), n + 1);
    assert_true(audit_rig_verify(audit).sound);
    iso_audit_close(audit);
}

/* A process that is killed while it writes loses at most the record that was not reported. */
static void survives_kills(void **state)
{
    for (int round = 0; round < 8; round++) {
        int fds[2], reported = 0;
        char byte;
        (void)unlink(scratch_path(*state, "a.log"));
        (void)unlink(scratch_path(*state, "a.log.anchor"));
        assert_int_equal(pipe(fds), 0);
        const pid_t pid = fork();
        assert_true(pid >= 0);
        if (pid == 0) {
            struct iso_audit *audit = audit_rig_open(*state);
            while (audit_rig_append(audit, "x", NULL) == 0 && write(fds[1], "+", 1) == 1) {
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
        struct iso_audit *audit = audit_rig_open(*state);
        assert_in_range(iso_audit_last(audit), reported, reported + 1);
        iso_audit_close(audit);
    }
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, stores_setup, stores_teardown)
    const struct CMUnitTest tests[] = {
        TEST(writes_records),
        TEST(goes_on_counting),
        TEST(refuses_a_record_that_is_too_long),
        TEST(reads_from_anywhere),
        TEST(refuses_where_it_cannot_write),
        TEST(a_full_disk_leaves_whole_lines),
        TEST(survives_kills),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
