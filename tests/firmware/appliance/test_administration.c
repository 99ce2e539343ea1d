/* The changes that an administrator makes to the stores through the appliance, and the log lines
 * about them. */
#include <errno.h>
#include <fcntl.h>
#include <malloc.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "drivers/door/door_null.h"
#include "firmware/appliance/administration/administration.h"
#include "firmware/audit/journal.h"
#include "tests/firmware/rigs/puppets.h"
#include "tests/firmware/rigs/rig.h"
#include "tests/firmware/rigs/stores.h"
#include "tests/support/scratch.h"

static const struct iso_transfer_lock lock = {.key = {{7}}};

static int make_file(const struct rig *rig, const char *name)
{
    const int fd = open(scratch_path(rig->directory, name), O_RDWR | O_CREAT | O_EXCL, 0600);
    assert_true(fd >= 0);
    return fd;
}

static void carries_people_on_record(void **state)
{
    struct rig *rig = *state;
    size_t n = 0, added = 0, known = 0;
    rig_enrol(rig, "anna", 50);
    rig_enrol(rig, "bob", 80);
    rig_start(rig);
    const int fd = make_file(rig, "people");
    assert_int_equal(iso_appliance_export(rig->appliance, fd, NULL, &lock, NULL, &n, NULL), 0);
    assert_int_equal(n, 2);
    assert_non_null(strstr(rig_record(rig, "export"), "\"reason\":\"done\",\"note\":\"2 people\""));
    assert_int_equal(iso_appliance_remove(rig->appliance, "anna", NULL), 0);
    const struct iso_import_request request = {.fd = fd, .key = &lock.key};
    assert_int_equal(iso_appliance_import(rig->appliance, &request, &added, &known, NULL), 0);
    assert_int_equal(added, 1);
    assert_int_equal(known, 1);
    assert_non_null(
        strstr(rig_record(rig, "import"), "\"reason\":\"done\",\"note\":\"1 of 2 people\""));
    /* A person who was imported from a file is admitted at the door. */
    rig_show(rig, 50, 2);
    rig_run(rig, 200);
    assert_string_equal(rig_news(rig), "door unlocked grant; visit allow anna match 2");
    assert_int_equal(close(fd), 0);
}

static void refuses_files_that_are_not_fresh(void **state)
{
    struct rig *rig = *state;
    struct iso_fault fault = {.text = ""};
    size_t n = 0, added = 0, known = 0;
    int fds[2];
    rig_start(rig);
    assert_int_equal(pipe(fds), 0);
    assert_int_equal(iso_appliance_export(rig->appliance, fds[1], NULL, &lock, NULL, &n, &fault),
                     -EINVAL);
    assert_string_equal(fault.text, "this is not a file");
    const int fd = make_file(rig, "full");
    assert_int_equal(write(fd, "x", 1), 1);
    assert_int_equal(iso_appliance_export(rig->appliance, fd, NULL, &lock, NULL, &n, &fault),
                     -EINVAL);
    assert_string_equal(fault.text, "the file is not empty");
    const struct iso_import_request request = {.fd = fd, .key = &lock.key};
    assert_int_equal(iso_appliance_import(rig->appliance, &request, &added, &known, &fault),
                     -EBADMSG);
    assert_non_null(strstr(rig_record(rig, "import"), "\"reason\":\"failed\""));
    (void)close(fd);
    (void)close(fds[0]);
    (void)close(fds[1]);
}

static void waits_for_the_end_of_an_action(void **state)
{
    struct rig *rig = *state;
    const struct iso_enroll_request request = {.person = "eve"};
    const char *remark = NULL;
    struct iso_fault fault = {.text = ""};
    rig_start(rig);
    assert_int_equal(iso_appliance_claim(rig->appliance), 0);
    assert_int_equal(iso_appliance_enroll(rig->appliance, &request, NULL), 0);
    assert_int_equal(iso_appliance_rotate_keys(rig->appliance, NULL, &remark, &fault), -EBUSY);
    assert_string_equal(fault.text, "enroll goes on, stop it first");
}

static void rotates_every_key(void **state)
{
    static const enum iso_key_use uses[] = {ISO_KEY_GALLERY, ISO_KEY_ANCHOR};
    struct rig *rig = *state;
    struct iso_key_ring *ring = rig->borrowed.ring;
    uint32_t before[2];
    const char *remark = NULL;
    struct iso_audit_report report;
    size_t size = 0;
    rig_enrol(rig, "anna", 50);
    rig_start(rig);
    void *key = scratch_read(scratch_path(rig->directory, "g.db.key"), &size);
    for (int i = 0; i < 2; i++) {
        before[i] = iso_key_ring_newest(ring, uses[i]);
    }
    assert_int_equal(iso_appliance_rotate_keys(rig->appliance, NULL, &remark, NULL), 0);
    assert_string_equal(remark, "");
    for (int i = 0; i < 2; i++) {
        assert_true(iso_key_ring_newest(ring, uses[i]) > before[i]);
        assert_null(iso_key_ring_find(ring, uses[i], before[i]));
    }
    void *now = scratch_read(scratch_path(rig->directory, "g.db.key"), &size);
    assert_memory_not_equal(key, now, size);
    free(key);
    free(now);
    assert_int_equal(iso_audit_verify(rig->audit, 0, NULL, NULL, &report, NULL), 0);
    assert_true(report.sound);
    assert_non_null(strstr(rig_record(rig, "rotate-keys"), "\"reason\":\"done\""));
    rig_show(rig, 50, 2);
    rig_run(rig, 200);
    assert_string_equal(rig_news(rig), "door unlocked grant; visit allow anna match 2");
}

static void a_rotation_that_cannot_be_put_on_record_is_not_done(void **state)
{
    struct rig *rig = *state;
    const char *remark = NULL;
    const uint32_t before = iso_key_ring_newest(rig->borrowed.ring, ISO_KEY_GALLERY);
    rig_start(rig);
    rig_fill_disk();
    assert_int_equal(iso_appliance_rotate_keys(rig->appliance, NULL, &remark, NULL), -ENOSPC);
    rig_free_disk();
    assert_int_equal(iso_key_ring_newest(rig->borrowed.ring, ISO_KEY_GALLERY), before);
}

static void renames_on_record(void **state)
{
    struct rig *rig = *state;
    struct iso_fault fault = {.text = ""};
    const char *remark = NULL;
    rig_enrol(rig, "ada", 50);
    rig_enrol(rig, "bob", 80);
    rig_start(rig);
    assert_int_equal(iso_appliance_rename(rig->appliance, "ADA", "Ada Lovelace", &remark, NULL), 0);
    assert_string_equal(remark, "");
    assert_non_null(strstr(rig_record(rig, "rename"), "\"person\":\"ada\",\"before\":\"ada\","
                                                      "\"after\":\"Ada Lovelace\"}"));
    assert_non_null(strstr(rig_record(rig, "gallery"), "\"gallery\":"));
    rig_show(rig, 50, 2);
    rig_run(rig, 200);
    assert_string_equal(rig_news(rig), "door unlocked grant; visit allow Ada Lovelace match 2");
    assert_int_equal(iso_appliance_rename(rig->appliance, "ada lovelace", "BOB", &remark, &fault),
                     -EEXIST);
    assert_string_equal(fault.text, "somebody else is enrolled as bob");
    assert_int_equal(iso_appliance_rename(rig->appliance, "ada", "eve", &remark, &fault), -ENOENT);
    assert_int_equal(iso_appliance_rename(rig->appliance, "bob", " x", &remark, &fault), -EINVAL);
}

static void a_rename_reminds_of_the_cards(void **state)
{
    struct rig *rig = *state;
    struct iso_cards *cards = NULL;
    const char *remark = NULL;
    const char *path = scratch_path(rig->directory, "cards");
    scratch_write_text(path, "17 4711 Ada\n17 4712 carl\n");
    assert_int_equal(iso_cards_load(path, &cards, NULL), 0);
    rig->borrowed.cards = cards;
    iso_appliance_free(rig->appliance);
    assert_int_equal(iso_appliance_new(&rig->borrowed, &rig->appliance), 0);
    rig_enrol(rig, "ada", 50);
    rig_start(rig);
    assert_int_equal(iso_appliance_rename(rig->appliance, "ada", "ADA", &remark, NULL), 0);
    assert_string_equal(remark, ""); /* both spellings are one name */
    assert_int_equal(iso_appliance_rename(rig->appliance, "ada", "eve", &remark, NULL), 0);
    assert_non_null(strstr(remark, "the file of card numbers"));
    assert_int_equal(iso_appliance_rename(rig->appliance, "eve", "carl", &remark, NULL), 0);
    assert_non_null(strstr(remark, "has a number for the new name"));
    iso_cards_free(cards);
}

static bool is_in_appliance(const struct rig *rig, const char *text)
{
    return memmem(rig->appliance, malloc_usable_size(rig->appliance), text, strlen(text)) != NULL;
}

/* The texts of a later visit are shorter than the name. */
static void a_removed_name_is_in_no_text(void **state)
{
    struct rig *rig = *state;
    rig_enrol(rig, "maximiliane-of-the-hill", 50);
    rig_start(rig);
    rig_show(rig, 50, 2);
    rig_run(rig, 200);
    assert_string_equal(rig_news(rig),
                        "door unlocked grant; visit allow maximiliane-of-the-hill match 2");
    assert_true(is_in_appliance(rig, "of-the-hill"));
    rig_run(rig, 10000);
    rig_show(rig, 77, 2);
    rig_run(rig, 10000);
    assert_non_null(strstr(rig_news(rig), "visit deny"));
    assert_int_equal(iso_appliance_remove(rig->appliance, "maximiliane-of-the-hill", NULL), 0);
    assert_false(is_in_appliance(rig, "of-the-hill"));
}

static void changes_limits_on_record(void **state)
{
    struct rig *rig = *state;
    struct iso_fault fault = {.text = ""};
    const struct iso_validity_change from = {true, false, {1795300000, 0}, false};
    const struct iso_validity_change until = {false, true, {0, 1798675199}, false};
    struct iso_validity_change past = {true, true, {0, 1795000000}, false};
    rig_enrol(rig, "Anna", 50);
    rig_start(rig);
    assert_int_equal(iso_appliance_set_validity(rig->appliance, "anna", &from, NULL), 0);
    assert_int_equal(iso_appliance_set_validity(rig->appliance, "anna", &until, NULL), 0);
    const struct iso_person *anna = iso_gallery_find(rig->gallery, "Anna");
    assert_int_equal(anna->valid_from_s, 1795300000);
    assert_int_equal(anna->valid_until_s, 1798675199);
    assert_non_null(strstr(rig_record(rig, "validity"),
                           "\"person\":\"Anna\",\"before\":\"from 2026-11-21T22:26:40Z\","
                           "\"after\":\"from 2026-11-21T22:26:40Z until 2026-12-30T23:59:59Z\"}"));
    rig_show(rig, 50, 2);
    rig_run(rig, 200);
    assert_string_equal(rig_news(rig), "visit deny Anna not-valid 2");
    assert_int_equal(iso_appliance_set_validity(rig->appliance, "anna", &past, &fault), -EINVAL);
    assert_non_null(strstr(fault.text, "in the past"));
    past.expired = true;
    assert_int_equal(iso_appliance_set_validity(rig->appliance, "anna", &past, NULL), 0);
    assert_int_equal(iso_appliance_set_validity(rig->appliance, "zac", &past, NULL), -ENOENT);
}

static void a_change_that_cannot_be_put_on_record_is_not_made(void **state)
{
    struct rig *rig = *state;
    const struct iso_validity_change until = {false, true, {0, 1798675199}, false};
    const struct iso_enroll_request request = {.person = "eve"};
    const char *remark = NULL;
    rig_enrol(rig, "ada", 50);
    rig_start(rig);
    rig_fill_disk();
    assert_int_equal(iso_appliance_rename(rig->appliance, "ada", "bob", &remark, NULL), -ENOSPC);
    assert_int_equal(iso_appliance_set_validity(rig->appliance, "ada", &until, NULL), -ENOSPC);
    rig_free_disk();
    assert_null(iso_gallery_find(rig->gallery, "bob"));
    assert_int_equal(iso_gallery_find(rig->gallery, "ada")->valid_until_s, 0);
    assert_int_equal(iso_appliance_claim(rig->appliance), 0);
    assert_int_equal(iso_appliance_enroll(rig->appliance, &request, NULL), 0);
    assert_int_equal(iso_appliance_rename(rig->appliance, "ada", "bob", &remark, NULL), -EBUSY);
    assert_int_equal(iso_appliance_set_validity(rig->appliance, "ada", &until, NULL), -EBUSY);
}

static void the_journal_gets_no_name(void **state)
{
    char fields[ISO_JOURNAL_FIELDS_MAX][ISO_JOURNAL_FIELD_SIZE];
    struct iso_audit_record record = iso_audit_record_of("visit");
    (void)state;
    record.person = "Wilhelmina";
    record.note = "Wilhelmina";
    record.verdict = "deny";
    record.reason = "unknown";
    record.score = 0.25;
    record.threshold = 0.62;
    record.frames = 6;
    record.attack_frames = 1;
    record.sensor = "started";
    const size_t n = iso_journal_fields(&record, 17, "abc", fields);
    static const char *const wanted[] = {"MESSAGE=record 17: visit deny, unknown",
                                         "PRIORITY=5",
                                         "ISOTHERM_EVENT=visit",
                                         "ISOTHERM_SEQUENCE=17",
                                         "ISOTHERM_HEAD=abc",
                                         "ISOTHERM_VERDICT=deny",
                                         "ISOTHERM_REASON=unknown",
                                         "ISOTHERM_SCORE=0.25",
                                         "ISOTHERM_THRESHOLD=0.62",
                                         "ISOTHERM_FRAMES=6",
                                         "ISOTHERM_ATTACK_FRAMES=1",
                                         "ISOTHERM_SENSOR=started"};
    assert_int_equal(n, sizeof wanted / sizeof *wanted);
    for (size_t i = 0; i < n; i++) {
        assert_string_equal(fields[i], wanted[i]);
    }
}

static void the_journal_gets_a_door_that_did_not_unlock(void **state)
{
    char fields[ISO_JOURNAL_FIELDS_MAX][ISO_JOURNAL_FIELD_SIZE];
    struct iso_audit_record record = iso_audit_record_of("visit");
    (void)state;
    record.verdict = "allow";
    record.door = "not-unlocked";
    record.reason = "match";
    (void)iso_journal_fields(&record, 18, "abc", fields);
    assert_string_equal(fields[0], "MESSAGE=record 18: visit allow, match, door not-unlocked");
    assert_string_equal(fields[1], "PRIORITY=4");
    assert_string_equal(fields[6], "ISOTHERM_DOOR=not-unlocked");
}

/* ---- the relay ---- */

static void tests_the_relay_on_record(void **state)
{
    struct rig *rig = *state;
    rig_start(rig);
    assert_int_equal(iso_appliance_test_door(rig->appliance, NULL), 0);
    assert_true(rig_relay(rig));
    assert_non_null(strstr(rig_record(rig, "door-test"), "\"reason\":\"done\""));
    assert_string_equal(rig_news(rig), "door unlocked test");
    rig_run(rig, 450);
    assert_true(rig_relay(rig));
    rig_run(rig, 100);
    assert_false(rig_relay(rig));
    assert_string_equal(rig_news(rig), "door locked time");
}

static void expect_no_test(struct rig *rig, int error, const char *text)
{
    struct iso_fault fault = {.text = ""};
    assert_int_equal(iso_appliance_test_door(rig->appliance, &fault), error);
    assert_string_equal(fault.text, text);
    assert_false(rig_relay(rig));
    assert_string_equal(rig_record(rig, "door-test"), "");
}

static void refuses_a_test_that_is_not_safe(void **state)
{
    struct rig *rig = *state;
    rig_start(rig);
    assert_int_equal(iso_appliance_claim(rig->appliance), 0);
    expect_no_test(rig, -EBUSY, "the camera is claimed, the door is not watched");
    iso_appliance_release(rig->appliance);
    assert_int_equal(iso_appliance_lockdown(rig->appliance, true, NULL), 0);
    expect_no_test(rig, -EPERM, "lockdown: nobody is let in");
    assert_int_equal(iso_appliance_lockdown(rig->appliance, false, NULL), 0);
    assert_int_equal(iso_door_null_set_input(rig->borrowed.door_io, ISO_DOOR_CONTACT, true), 0);
    rig_run(rig, 100);
    expect_no_test(rig, -EBUSY, "the door is forced, not locked");
    assert_int_equal(iso_door_null_set_input(rig->borrowed.door_io, ISO_DOOR_CONTACT, false), 0);
    rig_run(rig, 100);
    assert_int_equal(iso_appliance_test_door(rig->appliance, NULL), 0);
}

static void a_test_without_a_record_does_not_switch(void **state)
{
    struct rig *rig = *state;
    rig_start(rig);
    rig_fill_disk();
    assert_true(iso_appliance_test_door(rig->appliance, NULL) < 0);
    rig_free_disk();
    assert_false(rig_relay(rig));
    rig_run(rig, 100);
    assert_false(rig_relay(rig));
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, rig_setup, rig_teardown)
    const struct CMUnitTest tests[] = {
        TEST(carries_people_on_record),
        TEST(refuses_files_that_are_not_fresh),
        TEST(waits_for_the_end_of_an_action),
        TEST(rotates_every_key),
        TEST(a_rotation_that_cannot_be_put_on_record_is_not_done),
        TEST(renames_on_record),
        TEST(a_rename_reminds_of_the_cards),
        TEST(a_removed_name_is_in_no_text),
        TEST(changes_limits_on_record),
        TEST(a_change_that_cannot_be_put_on_record_is_not_made),
        TEST(tests_the_relay_on_record),
        TEST(refuses_a_test_that_is_not_safe),
        TEST(a_test_without_a_record_does_not_switch),
        cmocka_unit_test(the_journal_gets_no_name),
        cmocka_unit_test(the_journal_gets_a_door_that_did_not_unlock),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
