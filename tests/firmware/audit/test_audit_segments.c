/* An audit log of several segments: bounds, rotation, another key, and changes to old segments. */
#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "firmware/audit/audit_state.h"
#include "tests/firmware/rigs/audit_rig.h"
#include "tests/support/scratch.h"

static void is_bounded_and_verifies(void **state)
{
    struct iso_audit *audit = audit_rig_open_small(*state);
    for (int i = 0; i < 100; i++) {
        if (i == 50) {
            iso_audit_close(audit);
            audit = audit_rig_open_small(*state);
        }
        assert_int_equal(audit_rig_append(audit, "x", NULL), 0);
    }
    const struct iso_audit_report report = audit_rig_verify(audit);
    assert_true(report.sound);
    assert_true(report.first > 50);
    assert_int_equal(report.last, iso_audit_last(audit));
    assert_int_equal(report.first, iso_audit_first(audit));
    char *text = stores_log_text(audit);
    char begin[40];
    (void)snprintf(begin, sizeof begin, "{\"sequence\":%llu,", (unsigned long long)report.first);
    assert_memory_equal(text, begin, strlen(begin));
    assert_non_null(strstr(text, "\"event\":\"log-rotated\""));
    free(text);
    struct audit_rig_seen seen = {0};
    assert_int_equal(iso_audit_read(audit, report.first + 5, 20, audit_rig_see, &seen), 0);
    assert_int_equal(seen.n, 20); /* read across the ends of segments */
    assert_int_equal(seen.first, report.first + 5);
    iso_audit_close(audit);
}

struct reading {
    uint64_t last; /* number of the last record that was read */
    size_t n, gaps;
};

static int see_in_order(void *context, const char *line)
{
    struct reading *reading = context;
    uint64_t sequence = 0;
    assert_int_equal(sscanf(line, "{\"sequence\":%" SCNu64, &sequence), 1);
    assert_true(sequence > reading->last);
    reading->gaps += sequence != reading->last + 1;
    reading->last = sequence;
    reading->n++;
    return 0;
}

/* A reader takes small steps while records are added and old segments are removed. It reads up to
 * the last record; no record comes twice or out of order. Only records that were removed before the
 * reader asked for them are missing. */
static void is_read_while_it_grows_and_rotates(void **state)
{
    struct iso_audit *audit = audit_rig_open_small(*state);
    struct reading reading = {0};
    size_t batches_after_rotation = 0;
    for (int i = 0; i < 600; i++) {
        const uint64_t first = iso_audit_first(audit);
        for (int k = i % 5; k > 0; k--) {
            assert_int_equal(audit_rig_append(audit, "x", NULL), 0);
        }
        const size_t gaps = reading.gaps;
        const uint64_t next = reading.last + 1;
        const uint32_t max = i % 200 < 100 ? 3 : 1; /* the reader keeps up, or falls behind */
        assert_int_equal(iso_audit_read(audit, next, max, see_in_order, &reading), 0);
        assert_true(reading.gaps == gaps || next < iso_audit_first(audit));
        batches_after_rotation += iso_audit_first(audit) > first;
    }
    assert_true(batches_after_rotation > 20 && reading.gaps > 5);
    while (reading.last < iso_audit_last(audit)) {
        const uint64_t from = reading.last + 1 > iso_audit_first(audit) ? reading.last + 1
                                                                        : iso_audit_first(audit);
        const uint64_t left = iso_audit_last(audit) + 1 - from;
        const size_t before = reading.n;
        assert_int_equal(iso_audit_read(audit, from, 1000, see_in_order, &reading), 0);
        assert_int_equal(reading.n - before, left);
    }
    iso_audit_close(audit);
}

/* Returns the path of the oldest closed segment of a small log. */
static const char *oldest(const char *directory, const struct iso_audit *audit)
{
    char name[64];
    (void)snprintf(name, sizeof name, "a.log.%020llu", (unsigned long long)iso_audit_first(audit));
    return scratch_path(directory, name);
}

static void expect_flaw(struct iso_audit *audit, uint64_t at, const char *words)
{
    const struct iso_audit_report report = audit_rig_verify(audit);
    assert_false(report.sound);
    assert_int_equal(report.flaw_at, at);
    if (!strstr(report.flaw, words)) {
        fail_msg("'%s' does not say '%s'", report.flaw, words);
    }
}

static void verify_finds_changes_to_old_segments(void **state)
{
    struct iso_audit *audit = audit_rig_open_small(*state);
    size_t size = 0;
    for (int i = 0; i < 40; i++) {
        assert_int_equal(audit_rig_append(audit, "x", NULL), 0);
    }
    const uint64_t first = iso_audit_first(audit);
    const char *path = oldest(*state, audit);
    char *whole = scratch_read(path, &size);
    whole[size - 20] ^= 1; /* a bit of its last record */
    scratch_write(path, whole, size);
    struct iso_audit_report report = audit_rig_verify(audit);
    assert_false(report.sound);
    assert_true(report.flaw_at > first && report.flaw_at < first + 20);
    whole[size - 20] ^= 1;
    const size_t shorter = (size_t)((char *)memrchr(whole, '\n', size - 1) + 1 - whole);
    scratch_write(path, whole, shorter);
    report = audit_rig_verify(audit);
    assert_false(report.sound);
    assert_non_null(strstr(report.flaw, "is not the first of its segment, as it has to be"));
    (void)unlink(path);
    expect_flaw(audit, first, "and its whole segment are missing");
    scratch_write(path, whole, size);
    assert_true(audit_rig_verify(audit).sound);
    free(whole);
    iso_audit_close(audit);
}

static void a_known_head_reveals_a_log_that_was_begun_anew(void **state)
{
    struct iso_audit *audit = audit_rig_open(*state);
    struct iso_audit_report report;
    assert_int_equal(audit_rig_append(audit, "one", NULL), 0);
    const struct iso_audit_report then = audit_rig_verify(audit);
    assert_int_equal(audit_rig_append(audit, "two", NULL), 0);
    assert_int_equal(iso_audit_verify(audit, then.last, then.head, NULL, &report, NULL), 0);
    assert_true(report.sound);
    iso_audit_close(audit);

    (void)unlink(scratch_path(*state, "a.log"));
    (void)unlink(scratch_path(*state, "a.log.anchor"));
    audit = audit_rig_open(*state);
    assert_int_equal(audit_rig_append(audit, "one", NULL), 0);
    assert_int_equal(iso_audit_verify(audit, then.last, then.head, NULL, &report, NULL), 0);
    assert_false(report.sound);
    assert_non_null(strstr(report.flaw, "record 1 does not have the head that is known"));
    assert_int_equal(iso_audit_verify(audit, 7, then.head, NULL, &report, NULL), 0);
    assert_non_null(strstr(report.flaw, "record 7 is missing, but its head is known"));
    iso_audit_close(audit);
}

/* The log reads records sealed with the previous key and records sealed with the new one. The
 * previous key is removed with its last segment. */
static void goes_on_under_another_key(void **state)
{
    struct iso_audit *audit = audit_rig_open_small(*state);
    struct iso_key_ring *ring = stores_ring(*state);
    const uint32_t old = iso_key_ring_newest(ring, ISO_KEY_LOG);
    assert_int_equal(audit_rig_append(audit, "before", NULL), 0);
    assert_int_equal(iso_audit_rotate_key(audit, NULL), 0);
    const uint32_t new = iso_key_ring_newest(ring, ISO_KEY_LOG);
    assert_true(new > old);
    assert_int_equal(audit_rig_append(audit, "after", NULL), 0);
    assert_true(audit_rig_verify(audit).sound);
    char *text = stores_log_text(audit);
    assert_non_null(strstr(text, "\"event\":\"before\""));
    assert_non_null(strstr(text, "\"event\":\"after\""));
    free(text);
    assert_non_null(iso_key_ring_find(ring, ISO_KEY_LOG, old));
    for (int i = 0; i < 60; i++) {
        assert_int_equal(audit_rig_append(audit, "x", NULL), 0);
    }
    assert_null(iso_key_ring_find(ring, ISO_KEY_LOG, old));
    iso_audit_close(audit);
    audit = audit_rig_open_small(*state);
    assert_true(audit_rig_verify(audit).sound);
    iso_audit_close(audit);
}

/* A kill between the start of a new segment and its first record leaves a segment without records.
 */
static void a_segment_without_a_record_is_none(void **state)
{
    struct iso_audit *audit = audit_rig_open_small(*state);
    size_t size = 0;
    assert_int_equal(audit_rig_append(audit, "one", NULL), 0);
    stores_copy_file(*state, "a.log.anchor", "anchor.one");
    assert_int_equal(iso_audit_rotate_key(audit, NULL), 0);
    iso_audit_close(audit);
    char *whole = scratch_read(scratch_path(*state, "a.log"), &size);
    scratch_write(scratch_path(*state, "a.log"), whole, (size_t)(audit_rig_line(whole, 1) - whole));
    stores_copy_file(*state, "anchor.one", "a.log.anchor");
    free(whole);
    audit = audit_rig_open_small(*state);
    assert_int_equal(iso_audit_last(audit), 1);
    assert_int_equal(iso_audit_rotate_key(audit, NULL), 0);
    assert_int_equal(iso_audit_rotate_key(audit, NULL), 0);
    assert_true(audit_rig_verify(audit).sound);
    iso_audit_close(audit);
    audit = audit_rig_open_small(*state);
    assert_true(audit_rig_verify(audit).sound);
    iso_audit_close(audit);
}

static void remembers_the_gallery(void **state)
{
    struct iso_audit *audit = audit_rig_open_small(*state);
    struct iso_audit_record record = iso_audit_record_of("enroll");
    record.gallery = "0123456789abcdef";
    record.gallery_changes = 41;
    assert_int_equal(iso_audit_append(audit, &record, NULL), 0);
    for (int i = 0; i < 40; i++) {
        assert_int_equal(audit_rig_append(audit, "x", NULL), 0);
    }
    iso_audit_close(audit);
    audit = audit_rig_open_small(*state);
    assert_int_equal(iso_audit_gallery_changes(audit, "0123456789abcdef"), 41);
    assert_int_equal(iso_audit_gallery_changes(audit, "0123456789abcde0"), 0);
    iso_audit_close(audit);
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, stores_setup, stores_teardown)
    const struct CMUnitTest tests[] = {
        TEST(is_bounded_and_verifies),
        TEST(is_read_while_it_grows_and_rotates),
        TEST(verify_finds_changes_to_old_segments),
        TEST(a_known_head_reveals_a_log_that_was_begun_anew),
        TEST(goes_on_under_another_key),
        TEST(a_segment_without_a_record_is_none),
        TEST(remembers_the_gallery),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
