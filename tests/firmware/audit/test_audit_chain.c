/* The audit log's chain: what is done to the files is found, segments, keys, the version before. */
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

/* ---- damage ---- */

static const char *line_of(const char *text, int number)
{
    for (int i = 0; i < number; i++) {
        text += strcspn(text, "\n") + 1;
    }
    return text;
}

/* Three records; the file's text, to be freed. */
static char *make_three(const char *directory)
{
    struct iso_audit *audit = audit_rig_open(directory);
    assert_int_equal(audit_rig_append(audit, "one", NULL), 0);
    assert_int_equal(audit_rig_append(audit, "two", NULL), 0);
    assert_int_equal(audit_rig_append(audit, "three", NULL), 0);
    iso_audit_close(audit);
    return audit_rig_file(directory);
}

/* The anchor of the moment, put aside and put back. */
static void copy_file(const char *directory, const char *from, const char *to)
{
    size_t size = 0;
    void *bytes = scratch_read(scratch_path(directory, from), &size);
    scratch_write(scratch_path(directory, to), bytes, size);
    free(bytes);
}

/* A kill between the record and its anchor leaves a torn line behind what the anchor knows. */
static void takes_a_torn_line_away(void **state)
{
    struct iso_audit *audit = audit_rig_open(*state);
    assert_int_equal(audit_rig_append(audit, "one", NULL), 0);
    copy_file(*state, "a.log.anchor", "anchor.one");
    assert_int_equal(audit_rig_append(audit, "two", NULL), 0);
    iso_audit_close(audit);
    char *whole = audit_rig_file(*state);
    const size_t begin = (size_t)(line_of(whole, 2) - whole);
    for (size_t length = begin + 1; length < strlen(whole); length += 40) {
        char note[64];
        copy_file(*state, "anchor.one", "a.log.anchor");
        scratch_write(scratch_path(*state, "a.log"), whole, length);
        audit = audit_rig_open(*state);
        assert_int_equal(iso_audit_last(audit), 2);
        iso_audit_close(audit);
        char *text = audit_rig_log(*state);
        (void)snprintf(note, sizeof note,
                       "\"note\":\"%zu bytes of an unfinished record taken away\"}",
                       length - begin);
        assert_non_null(strstr(text, "\n{\"sequence\":2,"));
        assert_non_null(strstr(text, "\"event\":\"log-recovered\""));
        assert_non_null(strstr(text, note));
        free(text);
    }
    free(whole);
}

/* It is refused with such words, and left as it is. */
static void expect_refusal(const char *directory, const char *text, int error, const char *message)
{
    struct iso_audit *audit = NULL;
    struct iso_fault fault = {.text = ""};
    scratch_write_text(scratch_path(directory, "a.log"), text);
    const int got = audit_rig_try_open(directory, &audit, &fault);
    if (got != error || !strstr(fault.text, message)) {
        fail_msg("%d, '%s' does not say '%s'", got, fault.text, message);
    }
    char *after = audit_rig_file(directory);
    assert_string_equal(after, text);
    free(after);
}

static void refuses_a_log_that_was_changed(void **state)
{
    char text[4096];
    char *whole = make_three(*state);
    const char *const lines[] = {line_of(whole, 0), line_of(whole, 1), line_of(whole, 2),
                                 line_of(whole, 3)};
    (void)snprintf(text, sizeof text, "%.*s%s", (int)(lines[2] - whole), whole, lines[3]);
    expect_refusal(*state, text, -EBADMSG, "/a.log: record 2 was changed, or is not where it");
    (void)snprintf(text, sizeof text, "%.*s%s", (int)(lines[3] - whole), whole, lines[2]);
    expect_refusal(*state, text, -EBADMSG, "/a.log: record 3 was changed");
    (void)snprintf(text, sizeof text, "%.*s", (int)(lines[3] - whole), whole);
    expect_refusal(*state, text, -ESTALE, "/a.log: record 3 and what came after it are missing");
    (void)snprintf(text, sizeof text, "%.*s", (int)(lines[1] - whole), whole);
    expect_refusal(*state, text, -ESTALE, "/a.log: record 1 and what came after it are missing");
    expect_refusal(*state, "", -ESTALE, "/a.log: record 1 and what came after it are missing");
    (void)unlink(scratch_path(*state, "a.log"));
    expect_refusal(*state, "", -ESTALE, "/a.log: record 1 and what came after it are missing");
    expect_refusal(*state, "hello\n", -EBADMSG, "/a.log: has no header that is sound");
    expect_refusal(*state, "{\"sequence\":1,\"x\":0}\n", -ESTALE,
                   "a log in plain text, where there was a sealed one");
    scratch_write_text(scratch_path(*state, "a.log"), whole);
    iso_audit_close(audit_rig_open(*state));
    free(whole);
}

/* Every byte of it counts. */
static void finds_a_flipped_bit_anywhere(void **state)
{
    char *whole = make_three(*state);
    const size_t size = strlen(whole);
    for (size_t at = 0; at < size; at += 5) {
        struct iso_audit *audit = NULL;
        whole[at] ^= 0x04;
        scratch_write(scratch_path(*state, "a.log"), whole, size);
        const int error = audit_rig_try_open(*state, &audit, NULL);
        if (!error || (error != -EBADMSG && error != -ESTALE)) {
            fail_msg("byte %zu: %d", at, error);
        }
        whole[at] ^= 0x04;
    }
    free(whole);
}

static void refuses_an_old_log(void **state)
{
    struct iso_audit *audit = audit_rig_open(*state);
    struct iso_fault fault = {.text = ""};
    assert_int_equal(audit_rig_append(audit, "one", NULL), 0);
    copy_file(*state, "a.log", "old.log");
    copy_file(*state, "a.log.anchor", "old.anchor");
    for (int i = 0; i < 3; i++) {
        assert_int_equal(audit_rig_append(audit, "more", NULL), 0);
    }
    iso_audit_close(audit);
    copy_file(*state, "a.log", "new.log");
    copy_file(*state, "a.log.anchor", "new.anchor");

    copy_file(*state, "old.log", "a.log");
    assert_int_equal(audit_rig_try_open(*state, &audit, &fault), -ESTALE);
    assert_non_null(strstr(fault.text, "record 2 and what came after it are missing"));
    copy_file(*state, "new.log", "a.log");
    copy_file(*state, "old.anchor", "a.log.anchor");
    assert_int_equal(audit_rig_try_open(*state, &audit, &fault), -ESTALE);
    assert_non_null(strstr(fault.text, "its anchor is an old one"));
    (void)unlink(scratch_path(*state, "a.log.anchor"));
    assert_int_equal(audit_rig_try_open(*state, &audit, &fault), -ESTALE);
    assert_non_null(strstr(fault.text, "its anchor is gone"));
    copy_file(*state, "new.anchor", "a.log.anchor");
    iso_audit_close(audit_rig_open(*state));
}

/* ---- segments ---- */

static struct iso_audit *open_small(const char *directory)
{
    struct iso_audit_options options = stores_audit(directory);
    struct iso_audit *audit = NULL;
    struct iso_fault fault = {.text = ""};
    options.sync = false;
    options.segment_bytes = 2200;
    options.segments = 3;
    if (iso_audit_open(&options, &audit_rig_times, &audit, &fault)) {
        fail_msg("%s", fault.text);
    }
    return audit;
}

static void is_bounded_and_verifies(void **state)
{
    struct iso_audit *audit = open_small(*state);
    for (int i = 0; i < 100; i++) {
        if (i == 50) {
            iso_audit_close(audit);
            audit = open_small(*state);
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
    assert_int_equal(seen.n, 20); /* over the ends of segments */
    assert_int_equal(seen.first, report.first + 5);
    iso_audit_close(audit);
}

struct reading {
    uint64_t last; /* number of the record seen last */
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

/* A reader in small steps, while records come and old segments go: nothing twice, nothing out of
 * order, nothing missing but what has gone before it was asked for; up to the last. */
static void is_read_while_it_grows_and_rotates(void **state)
{
    struct iso_audit *audit = open_small(*state);
    struct reading reading = {0};
    size_t batches_after_rotation = 0;
    for (int i = 0; i < 600; i++) {
        const uint64_t first = iso_audit_first(audit);
        for (int k = i % 5; k > 0; k--) {
            assert_int_equal(audit_rig_append(audit, "x", NULL), 0);
        }
        const size_t gaps = reading.gaps;
        const uint64_t next = reading.last + 1;
        const uint32_t max = i % 200 < 100 ? 3 : 1; /* keeps up, or falls behind */
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

/* The path of the oldest closed segment of a small log. */
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

static void verify_finds_what_was_done_to_old_segments(void **state)
{
    struct iso_audit *audit = open_small(*state);
    size_t size = 0;
    for (int i = 0; i < 40; i++) {
        assert_int_equal(audit_rig_append(audit, "x", NULL), 0);
    }
    const uint64_t first = iso_audit_first(audit);
    const char *path = oldest(*state, audit);
    char *whole = scratch_read(path, &size);
    whole[size - 20] ^= 1; /* in its last record */
    scratch_write(path, whole, size);
    struct iso_audit_report report = audit_rig_verify(audit);
    assert_false(report.sound);
    assert_true(report.flaw_at > first && report.flaw_at < first + 20);
    whole[size - 20] ^= 1;
    const size_t shorter = (size_t)((char *)memrchr(whole, '\n', size - 1) + 1 - whole);
    scratch_write(path, whole, shorter);
    report = audit_rig_verify(audit);
    assert_false(report.sound);
    assert_non_null(strstr(report.flaw, "does not begin the segment that has to begin with it"));
    (void)unlink(path);
    expect_flaw(audit, first, "and its whole segment are missing");
    scratch_write(path, whole, size);
    assert_true(audit_rig_verify(audit).sound);
    free(whole);
    iso_audit_close(audit);
}

static void a_known_head_convicts_a_log_that_was_begun_anew(void **state)
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
    assert_non_null(strstr(report.flaw, "record 1 is another one than the head that is known"));
    assert_int_equal(iso_audit_verify(audit, 7, then.head, NULL, &report, NULL), 0);
    assert_non_null(strstr(report.flaw, "record 7 is known and missing"));
    iso_audit_close(audit);
}

/* What was sealed with the key before is read, what comes with the new one; the old key goes with
 * its last segment. */
static void goes_on_under_another_key(void **state)
{
    struct iso_audit *audit = open_small(*state);
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
    audit = open_small(*state);
    assert_true(audit_rig_verify(audit).sound);
    iso_audit_close(audit);
}

/* Without synchronising, only what came before the last start or segment is certain. */
static void without_sync_the_anchor_follows_later(void **state)
{
    struct iso_audit *audit = open_small(*state);
    struct iso_fault fault = {.text = ""};
    assert_int_equal(audit_rig_append(audit, "one", NULL), 0);
    iso_audit_close(audit);
    copy_file(*state, "a.log", "one.log");
    audit = open_small(*state);
    for (int i = 0; i < 5; i++) {
        assert_int_equal(audit_rig_append(audit, "x", NULL), 0);
    }
    copy_file(*state, "a.log", "six.log");
    copy_file(*state, "a.log.anchor", "killed.anchor"); /* as a kill would leave it */
    iso_audit_close(audit);
    copy_file(*state, "one.log", "a.log");
    assert_int_equal(audit_rig_try_open(*state, &audit, &fault), -ESTALE);
    copy_file(*state, "killed.anchor", "a.log.anchor");
    copy_file(*state, "six.log", "a.log");
    audit = audit_rig_open(*state); /* which synchronises */
    assert_int_equal(iso_audit_last(audit), 6);
    iso_audit_close(audit);
    copy_file(*state, "one.log", "a.log");
    assert_int_equal(audit_rig_try_open(*state, &audit, &fault), -ESTALE);
}

/* A kill between the new segment and its first record leaves one without any. */
static void a_segment_without_a_record_is_none(void **state)
{
    struct iso_audit *audit = open_small(*state);
    size_t size = 0;
    assert_int_equal(audit_rig_append(audit, "one", NULL), 0);
    copy_file(*state, "a.log.anchor", "anchor.one");
    assert_int_equal(iso_audit_rotate_key(audit, NULL), 0);
    iso_audit_close(audit);
    char *whole = scratch_read(scratch_path(*state, "a.log"), &size);
    scratch_write(scratch_path(*state, "a.log"), whole, (size_t)(line_of(whole, 1) - whole));
    copy_file(*state, "anchor.one", "a.log.anchor");
    free(whole);
    audit = open_small(*state);
    assert_int_equal(iso_audit_last(audit), 1);
    assert_int_equal(iso_audit_rotate_key(audit, NULL), 0);
    assert_int_equal(iso_audit_rotate_key(audit, NULL), 0);
    assert_true(audit_rig_verify(audit).sound);
    iso_audit_close(audit);
    audit = open_small(*state);
    assert_true(audit_rig_verify(audit).sound);
    iso_audit_close(audit);
}

static void remembers_the_gallery(void **state)
{
    struct iso_audit *audit = open_small(*state);
    struct iso_audit_record record = iso_audit_record_of("enroll");
    record.gallery = "0123456789abcdef";
    record.gallery_changes = 41;
    assert_int_equal(iso_audit_append(audit, &record, NULL), 0);
    for (int i = 0; i < 40; i++) {
        assert_int_equal(audit_rig_append(audit, "x", NULL), 0);
    }
    iso_audit_close(audit);
    audit = open_small(*state);
    assert_int_equal(iso_audit_gallery_changes(audit, "0123456789abcdef"), 41);
    assert_int_equal(iso_audit_gallery_changes(audit, "0123456789abcde0"), 0);
    iso_audit_close(audit);
}

/* ---- the version before ---- */

static void seals_a_log_in_plain_text(void **state)
{
    static const char plain[] = "{\"sequence\":1,\"event\":\"start\"}\n"
                                "{\"sequence\":2,\"person\":\"Wilhelmina\"}\n"
                                "{\"sequence\":3,\"ev";
    scratch_write_text(scratch_path(*state, "a.log"), plain);
    struct iso_audit *audit = audit_rig_open(*state);
    assert_int_equal(iso_audit_last(audit), 3);
    assert_true(audit_rig_verify(audit).sound);
    iso_audit_close(audit);
    char *text = audit_rig_log(*state), *file = audit_rig_file(*state);
    assert_memory_equal(text, plain, (size_t)(line_of(plain, 2) - plain));
    assert_non_null(strstr(text, "\"event\":\"log-sealed\""));
    assert_non_null(strstr(text, "records to 2 were not protected until now"));
    assert_null(strstr(file, "Wilhelmina"));
    free(text);
    free(file);
}

static void a_damaged_log_in_plain_text_is_left_alone(void **state)
{
    expect_refusal(*state, "{\"sequence\":1,\"x\":0}\n{\"sequence\":3,\"x\":0}\n", -EBADMSG,
                   "/a.log:2: damaged, or not record 2; move the file away to begin a new log");
}

/* After an exchange of files that failed the log is opened again. Meanwhile somebody has put the
 * file of an earlier time in its place, with its anchor: only the running daemon knows better. */
static void what_was_written_is_missed_when_the_log_is_opened_again(void **state)
{
    struct iso_fault fault = {.text = ""};
    struct iso_audit *audit = audit_rig_open(*state);
    assert_int_equal(audit_rig_append(audit, "one", NULL), 0);
    copy_file(*state, "a.log", "log.one");
    copy_file(*state, "a.log.anchor", "anchor.one");
    assert_int_equal(audit_rig_append(audit, "two", NULL), 0);
    copy_file(*state, "log.one", "a.log");
    copy_file(*state, "anchor.one", "a.log.anchor");
    assert_int_equal(iso__audit_recover(audit, &fault), -ESTALE);
    assert_non_null(strstr(fault.text, "records are missing that were written"));
    assert_int_not_equal(audit_rig_append(audit, "three", NULL), 0);
    iso_audit_close(audit);
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, stores_setup, stores_teardown)
    const struct CMUnitTest tests[] = {
        TEST(takes_a_torn_line_away),
        TEST(refuses_a_log_that_was_changed),
        TEST(finds_a_flipped_bit_anywhere),
        TEST(refuses_an_old_log),
        TEST(is_bounded_and_verifies),
        TEST(is_read_while_it_grows_and_rotates),
        TEST(verify_finds_what_was_done_to_old_segments),
        TEST(a_known_head_convicts_a_log_that_was_begun_anew),
        TEST(goes_on_under_another_key),
        TEST(without_sync_the_anchor_follows_later),
        TEST(a_segment_without_a_record_is_none),
        TEST(remembers_the_gallery),
        TEST(seals_a_log_in_plain_text),
        TEST(a_damaged_log_in_plain_text_is_left_alone),
        TEST(what_was_written_is_missed_when_the_log_is_opened_again),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
