/* Groups of records. One synchronisation serves the whole group, and the log recovers from a crash
 * within a group. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "tests/firmware/rigs/audit_rig.h"
#include "tests/support/scratch.h"

enum { GROUP = 5 };

/* ---- helpers ---- */

/* Saves a file of the log under another name, or restores it. */
static void copy_file(const char *directory, const char *from, const char *to)
{
    size_t size = 0;
    char *bytes = scratch_read(scratch_path(directory, from), &size);
    scratch_write(scratch_path(directory, to), bytes, size);
    free(bytes);
}

/* Appends a group; returns how many of its records were written. */
static int append_group(struct iso_audit *audit)
{
    const struct iso_audit_record record = iso_audit_record_of("x");
    struct iso_audit_entry entries[GROUP];
    int written = 0;
    for (int i = 0; i < GROUP; i++) {
        entries[i] = (struct iso_audit_entry){.record = &record};
    }
    const uint64_t before = iso_audit_last(audit);
    iso_audit_append_group(audit, entries, GROUP);
    for (int i = 0; i < GROUP; i++) {
        written += entries[i].error == 0;
        assert_true(entries[i].error || entries[i].sequence > before);
    }
    return written;
}

/* ---- tests ---- */

static void a_group_is_in_order_and_chained(void **state)
{
    struct iso_audit *audit = audit_rig_open(*state);
    struct audit_rig_seen seen = {0};
    assert_int_equal(append_group(audit), GROUP);
    assert_int_equal(append_group(audit), GROUP);
    assert_int_equal(iso_audit_last(audit), 2 * GROUP);
    assert_int_equal(iso_audit_read(audit, 1, 100, audit_rig_see, &seen), 0);
    assert_int_equal(seen.n, 2 * GROUP);
    assert_true(audit_rig_verify(audit).sound);
    iso_audit_close(audit);
    audit = audit_rig_open(*state);
    assert_int_equal(iso_audit_last(audit), 2 * GROUP);
    iso_audit_close(audit);
}

/* The power fails after the synchronisation of a group and before the anchor is written. */
static void a_group_whose_anchor_was_not_written_is_kept(void **state)
{
    struct iso_audit *audit = audit_rig_open(*state);
    assert_int_equal(audit_rig_append(audit, "one", NULL), 0);
    copy_file(*state, "a.log.anchor", "anchor.one");
    assert_int_equal(append_group(audit), GROUP);
    iso_audit_close(audit);
    copy_file(*state, "anchor.one", "a.log.anchor");
    audit = audit_rig_open(*state);
    assert_int_equal(iso_audit_last(audit), 1 + GROUP);
    assert_int_equal(audit_rig_append(audit, "two", NULL), 0);
    assert_true(audit_rig_verify(audit).sound);
    iso_audit_close(audit);
    iso_audit_close(audit_rig_open(*state));
}

/* The first records of the log are a group. */
static void the_first_group_is_kept_without_its_anchor(void **state)
{
    struct iso_audit *audit = audit_rig_open(*state);
    copy_file(*state, "a.log.anchor", "anchor.none");
    assert_int_equal(append_group(audit), GROUP);
    iso_audit_close(audit);
    copy_file(*state, "anchor.none", "a.log.anchor");
    audit = audit_rig_open(*state);
    assert_int_equal(iso_audit_last(audit), GROUP);
    iso_audit_close(audit);
}

/* One record after a group proves that the group's anchor was on the disk. */
static void an_anchor_from_before_a_group_is_an_old_one(void **state)
{
    struct iso_fault fault = {.text = ""};
    struct iso_audit *audit = audit_rig_open(*state);
    assert_int_equal(audit_rig_append(audit, "one", NULL), 0);
    copy_file(*state, "a.log.anchor", "anchor.one");
    assert_int_equal(append_group(audit), GROUP);
    assert_int_equal(audit_rig_append(audit, "two", NULL), 0);
    iso_audit_close(audit);
    copy_file(*state, "anchor.one", "a.log.anchor");
    assert_int_equal(audit_rig_try_open(*state, &audit, &fault), -ESTALE);
    assert_non_null(strstr(fault.text, "its anchor is an old one"));
}

/* The power fails while the lines of a group are written. Some lines are complete, and one is cut
 * short. */
static void a_group_that_was_cut_short_leaves_whole_records(void **state)
{
    struct iso_audit *audit = audit_rig_open(*state);
    size_t whole = 0, size = 0;
    assert_int_equal(audit_rig_append(audit, "one", NULL), 0);
    copy_file(*state, "a.log.anchor", "anchor.one");
    free(scratch_read(scratch_path(*state, "a.log"), &whole));
    assert_int_equal(append_group(audit), GROUP);
    iso_audit_close(audit);
    char *bytes = scratch_read(scratch_path(*state, "a.log"), &size);
    const size_t line = (size - whole) / GROUP;
    scratch_write(scratch_path(*state, "a.log"), bytes, whole + 2 * line + line / 2);
    free(bytes);
    copy_file(*state, "anchor.one", "a.log.anchor");
    audit = audit_rig_open(*state);
    assert_int_equal(iso_audit_last(audit), 4); /* the first, two of the group, log-recovered */
    assert_true(audit_rig_verify(audit).sound);
    iso_audit_close(audit);
}

static void a_group_goes_on_in_the_next_segment(void **state)
{
    struct iso_audit *audit = NULL;
    struct iso_audit_options options = stores_audit(*state);
    options.segment_bytes = 1500;
    options.segments = 50;
    assert_int_equal(iso_audit_open(&options, &audit_rig_times, &audit, NULL), 0);
    for (int i = 0; i < 10; i++) {
        assert_int_equal(append_group(audit), GROUP);
    }
    const struct iso_audit_report report = audit_rig_verify(audit);
    assert_true(report.sound);
    assert_int_equal(report.first, 1);
    assert_true(report.last > 50 + 5); /* these, and the records that begin segments */
    iso_audit_close(audit);
    assert_int_equal(iso_audit_open(&options, &audit_rig_times, &audit, NULL), 0);
    assert_int_equal(iso_audit_last(audit), report.last);
    iso_audit_close(audit);
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, stores_setup, stores_teardown)
    const struct CMUnitTest tests[] = {
        TEST(a_group_is_in_order_and_chained),
        TEST(a_group_whose_anchor_was_not_written_is_kept),
        TEST(the_first_group_is_kept_without_its_anchor),
        TEST(an_anchor_from_before_a_group_is_an_old_one),
        TEST(a_group_that_was_cut_short_leaves_whole_records),
        TEST(a_group_goes_on_in_the_next_segment),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
