/* The writer of the audit log: order, waiting, a full queue, and lost records. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "firmware/audit/audit_writer.h"
#include "tests/firmware/rigs/audit_rig.h"
#include "tests/firmware/rigs/rig.h"
#include "tests/support/disk/slow_disk.h"

enum { MOMENT_MS = 20 };

static struct iso_audit *audit;
static struct iso_audit_writer *writer;
static struct iso_times times;

static int open_writer(void **state, bool threaded)
{
    if (stores_setup(state)) {
        return -1;
    }
    audit = audit_rig_open(*state);
    times = audit_rig_times;
    return iso_audit_writer_new(audit, &times, threaded, &writer);
}

static int setup(void **state)
{
    return open_writer(state, true);
}

static int setup_without_thread(void **state)
{
    return open_writer(state, false);
}

/* Ends the writer and its log. The disk works again. */
static void close_log(void)
{
    slow_disk_go_on();
    iso_audit_writer_free(writer);
    iso_audit_close(audit);
    writer = NULL;
    audit = NULL;
}

static int teardown(void **state)
{
    rig_free_disk();
    close_log();
    return stores_teardown(state);
}

/* ---- helpers ---- */

static struct iso_audit_record named(const char *event, const char *note)
{
    struct iso_audit_record record = iso_audit_record_of(event);
    record.note = note;
    return record;
}

static int post(const char *note)
{
    const struct iso_audit_record record = named("noted", note);
    return iso_audit_writer_post(writer, &record, NULL);
}

static int append(const char *note, int64_t wait_ms, uint64_t *sequence)
{
    const struct iso_audit_record record = named("grant", note);
    return iso_audit_writer_append(
        writer, &record, wait_ms < 0 ? ISO_NEVER_NS : wait_ms * ISO_NS_PER_MS, sequence, NULL);
}

static int post_outcome(const char *note)
{
    const struct iso_audit_record record = named("visit", note);
    return iso_audit_writer_post_outcome(writer, &record, NULL);
}

/* Makes the disk hang with a record that was posted. */
static void hang(void)
{
    slow_disk_hang();
    assert_int_equal(post("hanging"), 0);
    slow_disk_await();
}

/* Makes the disk hang with a record for which nobody waits any more. It tries again if the thread
 * was not woken up in time to begin with the record, because such a record is removed from the
 * queue. */
static void append_late(const char *note)
{
    for (;;) {
        slow_disk_hang();
        assert_int_equal(append(note, MOMENT_MS, NULL), -ETIMEDOUT);
        if (slow_disk_waiting() > 0) {
            return;
        }
        slow_disk_go_on();
    }
}

struct told {
    char text[65536];
};

static int take_note(void *context, const char *line)
{
    struct told *told = context;
    char event[32] = "", note[64] = "";
    unsigned long grant = 0;
    const char *at = strstr(line, "\"event\":");
    assert_int_equal(sscanf(at, "\"event\":\"%31[^\"]\"", event), 1);
    at = strstr(line, "\"note\":");
    (void)sscanf(at ? at : "", "\"note\":\"%63[^\"]\"", note);
    at = strstr(line, "\"grant\":");
    (void)sscanf(at ? at : "", "\"grant\":%lu", &grant);
    const size_t used = strlen(told->text);
    (void)snprintf(told->text + used, sizeof told->text - used, grant ? "%s %s %lu; " : "%s %s; ",
                   event, note, grant);
    return 0;
}

/* Makes the disk work and waits until all records are written. Checks the chain of the log. Returns
 * event, note and grant of its records, "grant one; visit two 1; ". */
static const char *told_by_log(void)
{
    static struct told told;
    told.text[0] = '\0';
    slow_disk_go_on();
    struct iso_audit *held = iso_audit_writer_hold(writer);
    assert_int_equal(iso_audit_read(held, 1, UINT32_MAX, take_note, &told), 0);
    assert_true(audit_rig_verify(held).sound);
    iso_audit_writer_release(writer);
    return told.text;
}

/* ---- tests ---- */

static void a_post_does_not_wait(void **state)
{
    (void)state;
    hang();
    assert_int_equal(post("one"), 0);
    assert_int_equal(post("two"), 0);
    assert_int_equal(iso_audit_writer_last(writer), 0);
    assert_int_equal(slow_disk_waiting(), 1);
    assert_string_equal(told_by_log(), "noted hanging; noted one; noted two; ");
    assert_int_equal(iso_audit_writer_last(writer), 3);
}

static void an_append_waits_for_the_disk(void **state)
{
    uint64_t sequence = 0;
    (void)state;
    assert_int_equal(post("before"), 0);
    assert_int_equal(append("waited for", -1, &sequence), 0);
    assert_int_equal(sequence, 2);
    assert_int_equal(post_outcome("behind"), 0);
    assert_string_equal(told_by_log(), "noted before; grant waited for; visit behind 2; ");
}

static int64_t later_ns(void *context)
{
    (void)context;
    return INT64_C(1795250000) * ISO_NS_PER_S + 750 * ISO_NS_PER_MS;
}

/* The record has the time at which it was queued. The clock of the log is half a second behind. */
static void a_record_says_when_it_happened(void **state)
{
    times.wall_ns = later_ns;
    assert_int_equal(post("then"), 0);
    close_log();
    char *log = audit_rig_log(*state);
    assert_non_null(strstr(log, "\"time\":\"2026-11-21T08:33:20.750Z\""));
    free(log);
}

/* A record that is being written cannot be cancelled. Its outcome is a record after it. */
static void a_record_that_comes_late_is_denied_behind_it(void **state)
{
    (void)state;
    append_late("late");
    assert_int_equal(post_outcome("denied"), 0);
    assert_int_equal(slow_disk_waiting(), 1);
    assert_string_equal(told_by_log(), "grant late; visit denied 1; ");
}

static void a_record_that_nobody_waits_for_is_not_written(void **state)
{
    (void)state;
    hang();
    assert_int_equal(append("too late", MOMENT_MS, NULL), -ETIMEDOUT);
    assert_int_equal(post_outcome("denied"), 0);
    assert_string_equal(told_by_log(), "noted hanging; visit denied; ");
}

/* An outcome that is still queued belongs to the record before it, whatever record comes next. */
static void an_outcome_belongs_to_its_record(void **state)
{
    (void)state;
    append_late("first");
    assert_int_equal(post_outcome("of the first"), 0);
    assert_int_equal(append("second", MOMENT_MS, NULL), -ETIMEDOUT);
    assert_int_equal(post_outcome("of the second"), 0);
    assert_string_equal(told_by_log(), "grant first; visit of the first 1; visit of the second; ");
}

static void a_full_queue_takes_nothing_and_lost_records_are_counted(void **state)
{
    struct iso_fault fault = {.text = ""};
    char *end;
    int posted = 1, error = 0;
    (void)state;
    hang();
    while (post("more") == 0) {
        posted++;
    }
    assert_int_equal(posted, ISO_AUDIT_WRITER_RECORDS - 2);
    assert_int_equal(append("has a place", MOMENT_MS, NULL), -ETIMEDOUT);
    assert_int_equal(append("no room", -1, NULL), -ENOBUFS); /* returns at once */
    assert_int_equal(post("lost, too"), -ENOBUFS);
    assert_true(iso_audit_writer_take_result(writer, &error, &fault));
    assert_int_equal(error, -ENOBUFS);
    assert_non_null(strstr(fault.text, "queue is full"));
    assert_false(iso_audit_writer_take_result(writer, &error, &fault));
    const char *log = told_by_log();
    assert_int_equal(post("again"), 0);
    log = told_by_log();
    end = strstr(log, "records-lost");
    assert_non_null(end);
    assert_string_equal(end, "records-lost 2 records; noted again; ");
}

/* One place in the queue is reserved for the outcome of a queued grant. */
static void the_outcome_of_a_grant_has_its_place(void **state)
{
    (void)state;
    hang();
    for (int i = 0; i < ISO_AUDIT_WRITER_RECORDS - 3; i++) {
        assert_int_equal(post("more"), 0);
    }
    assert_int_equal(post("no room"), -ENOBUFS);
    assert_int_equal(append("the last but one", MOMENT_MS, NULL), -ETIMEDOUT);
    assert_int_equal(post("no room"), -ENOBUFS);
    assert_int_equal(post_outcome("the last"), 0);
    assert_int_equal(post_outcome("one too many"), -ENOBUFS);
}

/* For any number of waiting records, the disk writes once for all of them and once for the anchor.
 */
static void queued_records_are_synchronised_together(void **state)
{
    struct iso_audit_report report;
    (void)state;
    hang();
    const int before = slow_disk_calls(); /* calls for the hanging record; its anchor follows */
    for (int i = 0; i < 100; i++) {
        assert_int_equal(post("more"), 0);
    }
    slow_disk_go_on();
    audit = iso_audit_writer_hold(writer);
    assert_int_equal(slow_disk_calls(), before + 3);
    assert_int_equal(iso_audit_last(audit), 101);
    assert_int_equal(iso_audit_verify(audit, 0, NULL, NULL, &report, NULL), 0);
    assert_true(report.sound);
    iso_audit_writer_release(writer);
}

/* A record that is too long for its line is the only one that is lost. */
static void a_group_loses_only_records_that_cannot_be_written(void **state)
{
    static char text[2000]; /* JSON takes six characters for each of them */
    (void)state;
    memset(text, 1, sizeof text - 1);
    hang();
    assert_int_equal(post("before"), 0);
    assert_int_equal(post(text), 0);
    assert_int_equal(post("behind"), 0);
    (void)told_by_log();
    assert_int_equal(post("again"), 0); /* the loss is recorded before this one */
    assert_string_equal(told_by_log(), "noted hanging; noted before; noted behind; "
                                       "records-lost 1 record; noted again; ");
}

static void a_disk_that_is_full_loses_records_and_says_so(void **state)
{
    struct iso_fault fault = {.text = ""};
    int error = 0;
    (void)state;
    assert_int_equal(append("fits", -1, NULL), 0);
    rig_fill_disk();
    (void)post("lost");
    assert_int_equal(append("refused", -1, NULL), -ENOSPC);
    assert_true(iso_audit_writer_take_result(writer, &error, &fault));
    assert_int_equal(error, -ENOSPC);
    assert_non_null(strstr(fault.text, "the disk refused: No space left on device"));
    rig_free_disk();
    assert_int_equal(append("fits again", -1, NULL), 0);
    assert_string_equal(told_by_log(), "grant fits; records-lost 1 record; grant fits again; ");
}

static void queued_records_are_written_at_the_end(void **state)
{
    assert_int_equal(post("one"), 0);
    assert_int_equal(post("two"), 0);
    close_log();
    char *log = audit_rig_log(*state);
    assert_non_null(strstr(log, "\"note\":\"two\""));
    free(log);
}

static void a_record_that_is_too_long_is_refused(void **state)
{
    static char text[4000];
    (void)state;
    memset(text, 'x', sizeof text - 1);
    assert_int_equal(post(text), -EINVAL);
    assert_int_equal(append(text, -1, NULL), -EINVAL);
}

int main(void)
{
#define TEST(f)    cmocka_unit_test_setup_teardown(f, setup, teardown)
#define WITHOUT(f) cmocka_unit_test_setup_teardown(f, setup_without_thread, teardown)
    const struct CMUnitTest tests[] = {
        TEST(a_post_does_not_wait),
        TEST(an_append_waits_for_the_disk),
        WITHOUT(an_append_waits_for_the_disk),
        TEST(a_record_says_when_it_happened),
        TEST(a_record_that_comes_late_is_denied_behind_it),
        TEST(a_record_that_nobody_waits_for_is_not_written),
        TEST(an_outcome_belongs_to_its_record),
        TEST(a_full_queue_takes_nothing_and_lost_records_are_counted),
        TEST(the_outcome_of_a_grant_has_its_place),
        TEST(queued_records_are_synchronised_together),
        TEST(a_group_loses_only_records_that_cannot_be_written),
        TEST(a_disk_that_is_full_loses_records_and_says_so),
        WITHOUT(a_disk_that_is_full_loses_records_and_says_so),
        TEST(queued_records_are_written_at_the_end),
        TEST(a_record_that_is_too_long_is_refused),
        WITHOUT(a_record_that_is_too_long_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
