/* The audit log's chain. The log finds changes that were made to its files, also across segments,
 * changes of the key, and the previous version's format. */
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

/* Writes three records. Returns the text of the file, to be freed. */
static char *make_three(const char *directory)
{
    struct iso_audit *audit = audit_rig_open(directory);
    assert_int_equal(audit_rig_append(audit, "one", NULL), 0);
    assert_int_equal(audit_rig_append(audit, "two", NULL), 0);
    assert_int_equal(audit_rig_append(audit, "three", NULL), 0);
    iso_audit_close(audit);
    return audit_rig_file(directory);
}

/* A kill between the record and its anchor leaves a torn line after the last record that the anchor
 * covers. */
static void takes_a_torn_line_away(void **state)
{
    struct iso_audit *audit = audit_rig_open(*state);
    assert_int_equal(audit_rig_append(audit, "one", NULL), 0);
    stores_copy_file(*state, "a.log.anchor", "anchor.one");
    assert_int_equal(audit_rig_append(audit, "two", NULL), 0);
    iso_audit_close(audit);
    char *whole = audit_rig_file(*state);
    const size_t begin = (size_t)(audit_rig_line(whole, 2) - whole);
    for (size_t length = begin + 1; length < strlen(whole); length += 40) {
        char note[64];
        stores_copy_file(*state, "anchor.one", "a.log.anchor");
        scratch_write(scratch_path(*state, "a.log"), whole, length);
        audit = audit_rig_open(*state);
        assert_int_equal(iso_audit_last(audit), 2);
        iso_audit_close(audit);
        char *text = audit_rig_log(*state);
        (void)snprintf(note, sizeof note,
                       "\"note\":\"%zu bytes of an unfinished record were removed\"}",
                       length - begin);
        assert_non_null(strstr(text, "\n{\"sequence\":2,"));
        assert_non_null(strstr(text, "\"event\":\"log-recovered\""));
        assert_non_null(strstr(text, note));
        free(text);
    }
    free(whole);
}

/* Writes this text to the log's file. Asserts that the log is refused with this error and a fault
 * that contains the message, and that the file stays unchanged. */
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
    const char *const lines[] = {audit_rig_line(whole, 0), audit_rig_line(whole, 1),
                                 audit_rig_line(whole, 2), audit_rig_line(whole, 3)};
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

/* Every byte of the file is protected. The test changes every fifth one. */
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
    stores_copy_file(*state, "a.log", "old.log");
    stores_copy_file(*state, "a.log.anchor", "old.anchor");
    for (int i = 0; i < 3; i++) {
        assert_int_equal(audit_rig_append(audit, "more", NULL), 0);
    }
    iso_audit_close(audit);
    stores_copy_file(*state, "a.log", "new.log");
    stores_copy_file(*state, "a.log.anchor", "new.anchor");

    stores_copy_file(*state, "old.log", "a.log");
    assert_int_equal(audit_rig_try_open(*state, &audit, &fault), -ESTALE);
    assert_non_null(strstr(fault.text, "record 2 and what came after it are missing"));
    stores_copy_file(*state, "new.log", "a.log");
    stores_copy_file(*state, "old.anchor", "a.log.anchor");
    assert_int_equal(audit_rig_try_open(*state, &audit, &fault), -ESTALE);
    assert_non_null(strstr(fault.text, "its anchor is an old one"));
    (void)unlink(scratch_path(*state, "a.log.anchor"));
    assert_int_equal(audit_rig_try_open(*state, &audit, &fault), -ESTALE);
    assert_non_null(strstr(fault.text, "its anchor is gone"));
    stores_copy_file(*state, "new.anchor", "a.log.anchor");
    iso_audit_close(audit_rig_open(*state));
}

/* ---- segments ---- */

/* Without synchronisation, only the records before the last start or the last new segment are
 * certain. */
static void without_sync_the_anchor_follows_later(void **state)
{
    struct iso_audit *audit = audit_rig_open_small(*state);
    struct iso_fault fault = {.text = ""};
    assert_int_equal(audit_rig_append(audit, "one", NULL), 0);
    iso_audit_close(audit);
    stores_copy_file(*state, "a.log", "one.log");
    audit = audit_rig_open_small(*state);
    for (int i = 0; i < 5; i++) {
        assert_int_equal(audit_rig_append(audit, "x", NULL), 0);
    }
    stores_copy_file(*state, "a.log", "six.log");
    stores_copy_file(*state, "a.log.anchor",
                     "killed.anchor"); /* the anchor that a kill would leave */
    iso_audit_close(audit);
    stores_copy_file(*state, "one.log", "a.log");
    assert_int_equal(audit_rig_try_open(*state, &audit, &fault), -ESTALE);
    stores_copy_file(*state, "killed.anchor", "a.log.anchor");
    stores_copy_file(*state, "six.log", "a.log");
    audit = audit_rig_open(*state); /* opening the log synchronises it */
    assert_int_equal(iso_audit_last(audit), 6);
    iso_audit_close(audit);
    stores_copy_file(*state, "one.log", "a.log");
    assert_int_equal(audit_rig_try_open(*state, &audit, &fault), -ESTALE);
}

/* ---- the previous version ---- */

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
    assert_memory_equal(text, plain, (size_t)(audit_rig_line(plain, 2) - plain));
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

/* The log is opened again after an exchange of files that failed. Before that, an attacker has
 * replaced its file and its anchor by those of an earlier time. Only the running daemon can notice
 * this. */
static void missing_records_are_noticed_when_the_log_is_opened_again(void **state)
{
    struct iso_fault fault = {.text = ""};
    struct iso_audit *audit = audit_rig_open(*state);
    assert_int_equal(audit_rig_append(audit, "one", NULL), 0);
    stores_copy_file(*state, "a.log", "log.one");
    stores_copy_file(*state, "a.log.anchor", "anchor.one");
    assert_int_equal(audit_rig_append(audit, "two", NULL), 0);
    stores_copy_file(*state, "log.one", "a.log");
    stores_copy_file(*state, "anchor.one", "a.log.anchor");
    assert_int_equal(iso__audit_recover(audit, &fault), -ESTALE);
    assert_non_null(strstr(fault.text, "written records are missing"));
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
        TEST(without_sync_the_anchor_follows_later),
        TEST(seals_a_log_in_plain_text),
        TEST(a_damaged_log_in_plain_text_is_left_alone),
        TEST(missing_records_are_noticed_when_the_log_is_opened_again),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
