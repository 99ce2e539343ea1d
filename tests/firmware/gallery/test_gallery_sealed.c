/* The gallery at rest: what a thief learns from the files, and which exchanged, older or unsealed
 * parts the gallery finds. */
#include <errno.h>
#include <sqlite3.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "firmware/audit/anchor.h"
#include "firmware/gallery/gallery.h"
#include "tests/firmware/rigs/audit_rig.h"
#include "tests/firmware/rigs/gallery_rig.h"
#include "tests/firmware/rigs/puppets.h"
#include "tests/support/scratch.h"

static void expect_refusal(const char *directory, int error, const char *text)
{
    struct iso_gallery *gallery = NULL;
    struct iso_fault fault = {.text = ""};
    const int got = gallery_rig_try_open(directory, &gallery, &fault);
    if (got != error || !strstr(fault.text, text)) {
        fail_msg("%d, '%s' does not say '%s'", got, fault.text, text);
    }
    assert_null(gallery);
}

static void add(struct iso_gallery *gallery, const char *name, int face)
{
    struct iso_person person = {.enrolled_s = 1795250000 + face,
                                .valid_until_s = 1800000000 + face};
    const struct iso_template tmpl = puppet_template(face, PUPPET_ALGORITHM);
    (void)snprintf(person.name, sizeof person.name, "%s", name);
    assert_int_equal(iso_gallery_add(gallery, &person, &tmpl, NULL), 0);
}

/* anna has two templates, Bartholomew and Wilhelmina have one each: record 1 is anna, records 2 and
 * 3 are her templates, ... */
static void make_three(const char *directory)
{
    struct iso_gallery *gallery = gallery_rig_open(directory);
    add(gallery, "anna", 20);
    add(gallery, "anna", 21);
    add(gallery, "Bartholomew", 40);
    add(gallery, "Wilhelmina", 60);
    iso_gallery_close(gallery);
}

/* ---- a thief ---- */

static void expect_absent(const char *directory, const char *file, const void *bytes, size_t size)
{
    size_t length = 0;
    char *whole = scratch_read(scratch_path(directory, file), &length);
    if (memmem(whole, length, bytes, size)) {
        fail_msg("%s contains plain text", file);
    }
    free(whole);
}

/* Searches for names, dates, and any eight bytes of any template, in every file except the file of
 * the key. */
static void stolen_files_have_no_name_and_no_template(void **state)
{
    static const char *const files[] = {"g.db", "g.db.anchor", "g.db.keys", "a.log",
                                        "a.log.anchor"};
    static const char *const names[] = {"anna", "Bartholomew", "Wilhelmina", "ISOT\1"};
    struct iso_audit *audit = NULL;
    struct iso_audit_record record = iso_audit_record_of("visit");
    uint8_t bytes[ISO_TEMPLATE_BYTES_MAX];
    make_three(*state);
    audit = audit_rig_open(*state);
    record.person = "Wilhelmina";
    record.note = "Bartholomew";
    assert_int_equal(iso_audit_append(audit, &record, NULL), 0);
    iso_audit_close(audit);
    const struct iso_template tmpl = puppet_template(60, PUPPET_ALGORITHM);
    const int size = iso_template_serialise(&tmpl, bytes, sizeof bytes);
    assert_true(size > 0);
    for (size_t f = 0; f < sizeof files / sizeof *files; f++) {
        for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
            expect_absent(*state, files[f], names[i], strlen(names[i]));
        }
        expect_absent(*state, files[f], &(int64_t){1795250060}, sizeof(int64_t));
        expect_absent(*state, files[f], bytes, 24);
        for (int at = 64; at + 8 < size; at += 8) { /* a run of zeros would be found anywhere */
            static const uint8_t blank[8];
            if (memcmp(bytes + at, blank, 8) != 0) {
                expect_absent(*state, files[f], bytes + at, 8);
            }
        }
    }
}

/* The same search finds a name in a file that is not sealed. */
static void the_search_finds_a_name_in_plain_text(void **state)
{
    size_t size = 0;
    scratch_write_text(scratch_path(*state, "plain"), "here is Wilhelmina");
    char *whole = scratch_read(scratch_path(*state, "plain"), &size);
    assert_non_null(memmem(whole, size, "Wilhelmina", 10));
    free(whole);
}

/* Every name takes the same space. */
static void the_length_of_a_name_does_not_show(void **state)
{
    sqlite3 *db = NULL;
    sqlite3_stmt *query = NULL;
    make_three(*state);
    assert_int_equal(sqlite3_open(scratch_path(*state, "g.db"), &db), SQLITE_OK);
    assert_int_equal(sqlite3_prepare_v2(db, "SELECT count(DISTINCT length(record)) FROM person", -1,
                                        &query, NULL),
                     SQLITE_OK);
    assert_int_equal(sqlite3_step(query), SQLITE_ROW);
    assert_int_equal(sqlite3_column_int(query, 0), 1);
    assert_int_equal(sqlite3_finalize(query), SQLITE_OK);
    assert_int_equal(sqlite3_close(db), SQLITE_OK);
}

static void another_key_opens_nothing(void **state)
{
    make_three(*state);
    stores_forget();
    (void)unlink(scratch_path(*state, "g.db.keys"));
    (void)unlink(scratch_path(*state, "g.db.key"));
    expect_refusal(*state, -EBADMSG, "g.db.anchor: damaged, or the anchor of another store");
    (void)unlink(scratch_path(*state, "g.db.anchor"));
    expect_refusal(*state, -EKEYREJECTED, "the key ring has no key");
}

/* ---- records ---- */

static void exchanged_records_are_found(void **state)
{
    static const char *const changes[] = {
        /* templates of two people, of one person, and the people themselves */
        "CREATE TABLE t AS SELECT record FROM template WHERE id = 2;"
        "UPDATE template SET record = (SELECT record FROM template WHERE id = 5) WHERE id = 2;"
        "UPDATE template SET record = (SELECT record FROM t) WHERE id = 5; DROP TABLE t",
        "CREATE TABLE t AS SELECT record FROM template WHERE id = 2;"
        "UPDATE template SET record = (SELECT record FROM template WHERE id = 3) WHERE id = 2;"
        "UPDATE template SET record = (SELECT record FROM t) WHERE id = 3; DROP TABLE t",
        "CREATE TABLE t AS SELECT record FROM person WHERE id = 1;"
        "UPDATE person SET record = (SELECT record FROM person WHERE id = 4) WHERE id = 1;"
        "UPDATE person SET record = (SELECT record FROM t) WHERE id = 4; DROP TABLE t",
        /* the person of a template, its algorithm, its number */
        "UPDATE template SET person_id = 4 WHERE id = 2",
        "UPDATE template SET algorithm = algorithm + 1 WHERE id = 2",
        "UPDATE template SET id = 50 WHERE id = 2",
        /* a record that is missing, is there twice, or comes from elsewhere */
        "DELETE FROM template WHERE id = 2",
        "DELETE FROM template WHERE person_id = 6; DELETE FROM person WHERE id = 6",
        "INSERT INTO template SELECT 51, person_id, algorithm, record FROM template WHERE id = 2",
        "UPDATE head SET key = key + 1",
        "UPDATE head SET gallery = zeroblob(16)",
        "DELETE FROM head",
    };
    make_three(*state);
    stores_copy_file(*state, "g.db", "sound");
    for (size_t i = 0; i < sizeof changes / sizeof *changes; i++) {
        struct iso_gallery *gallery = NULL;
        gallery_rig_execute(*state, changes[i]);
        const int error = gallery_rig_try_open(*state, &gallery, NULL);
        if (error != -EBADMSG && error != -EKEYREJECTED) {
            fail_msg("%d after %s", error, changes[i]);
        }
        stores_copy_file(*state, "sound", "g.db");
    }
    iso_gallery_close(gallery_rig_open(*state));
}

/* An earlier record of the same person, sealed by the same key in the same place. */
static void an_old_record_is_found(void **state)
{
    make_three(*state);
    stores_copy_file(*state, "g.db", "old");
    struct iso_gallery *gallery = gallery_rig_open(*state);
    struct iso_person anna = {.name = "anna", .valid_until_s = 1};
    const struct iso_template tmpl = puppet_template(22, PUPPET_ALGORITHM);
    assert_int_equal(iso_gallery_add(gallery, &anna, &tmpl, NULL), 0);
    iso_gallery_close(gallery);
    char sql[512];
    (void)snprintf(sql, sizeof sql,
                   "ATTACH '%s' AS old; UPDATE person SET record = "
                   "(SELECT record FROM old.person WHERE id = 1) WHERE id = 1",
                   scratch_path(*state, "old"));
    gallery_rig_execute(*state, sql);
    expect_refusal(*state, -EBADMSG, "records are missing, or are old ones");
}

/* ---- whole databases ---- */

static void an_old_gallery_is_found(void **state)
{
    make_three(*state);
    stores_copy_file(*state, "g.db", "old");
    stores_copy_file(*state, "g.db.anchor", "old.anchor");
    struct iso_gallery *gallery = gallery_rig_open(*state);
    assert_int_equal(iso_gallery_remove(gallery, "Wilhelmina", NULL), 0);
    assert_int_equal(iso_gallery_remove(gallery, "anna", NULL), 0);
    const struct iso_gallery_version now = iso_gallery_version(gallery);
    iso_gallery_close(gallery);
    stores_copy_file(*state, "g.db", "new");
    stores_copy_file(*state, "g.db.anchor", "new.anchor");

    stores_copy_file(*state, "old", "g.db");
    expect_refusal(*state, -ESTALE, "/g.db: an old gallery, 2 changes behind");
    (void)unlink(scratch_path(*state, "g.db.anchor"));
    expect_refusal(*state, -ESTALE, "its anchor");
    (void)unlink(scratch_path(*state, "g.db"));
    stores_copy_file(*state, "new.anchor", "g.db.anchor");
    expect_refusal(*state, -ESTALE, "/g.db: is gone; put it back, or move");

    /* With its own old anchor the database can be opened. The number of changes, which is in the
     * log, shows that it is old. */
    stores_copy_file(*state, "old", "g.db");
    stores_copy_file(*state, "old.anchor", "g.db.anchor");
    gallery = gallery_rig_open(*state);
    const struct iso_gallery_version then = iso_gallery_version(gallery);
    assert_string_equal(then.gallery, now.gallery);
    assert_true(then.changes < now.changes);
    iso_gallery_close(gallery);
}

static void an_old_gallery_is_unreadable_after_a_rotation(void **state)
{
    make_three(*state);
    stores_copy_file(*state, "g.db", "old");
    stores_copy_file(*state, "g.db.anchor", "old.anchor");
    struct iso_gallery *gallery = gallery_rig_open(*state);
    assert_int_equal(iso_gallery_rotate(gallery, NULL, NULL), 0);
    add(gallery, "after", 80);
    iso_gallery_close(gallery);
    gallery = gallery_rig_open(*state);
    assert_int_equal(iso_gallery_find(gallery, "anna")->usable, 2);
    assert_non_null(iso_gallery_find(gallery, "after"));
    iso_gallery_close(gallery);
    stores_copy_file(*state, "old", "g.db");
    stores_copy_file(*state, "old.anchor", "g.db.anchor");
    expect_refusal(*state, -EKEYREJECTED, "an old gallery, or another ring");
}

static void anchors_can_be_sealed_anew(void **state)
{
    uint32_t number = 0;
    make_three(*state);
    struct iso_key_ring *ring = stores_ring(*state);
    struct iso_gallery *gallery = gallery_rig_open(*state);
    assert_int_equal(iso_key_ring_add(ring, ISO_KEY_ANCHOR, &number, NULL), 0);
    assert_int_equal(iso_gallery_renew_anchor(gallery, NULL), 0);
    assert_int_equal(iso_key_ring_drop(ring, ISO_KEY_ANCHOR, number, NULL), 0);
    iso_gallery_close(gallery);
    iso_gallery_close(gallery_rig_open(*state));
}

/* ---- the previous version ---- */

/* Makes a gallery in the format of version 1. It has one person with one template, and one template
 * from a newer version. */
static void make_version_1(const char *directory)
{
    uint8_t bytes[ISO_TEMPLATE_BYTES_MAX];
    sqlite3 *db = NULL;
    sqlite3_stmt *insert = NULL;
    const struct iso_template tmpl = puppet_template(20, PUPPET_ALGORITHM);
    const int size = iso_template_serialise(&tmpl, bytes, sizeof bytes);
    gallery_rig_execute(
        directory,
        "PRAGMA application_id = 0x49534f54; PRAGMA user_version = 1;"
        "CREATE TABLE person (id INTEGER PRIMARY KEY AUTOINCREMENT, name TEXT NOT NULL UNIQUE,"
        "  enrolled_s INTEGER NOT NULL, valid_from_s INTEGER NOT NULL,"
        "  valid_until_s INTEGER NOT NULL) STRICT;"
        "CREATE TABLE template (id INTEGER PRIMARY KEY AUTOINCREMENT, person_id INTEGER NOT "
        "NULL REFERENCES person (id) ON DELETE CASCADE, algorithm INTEGER NOT NULL, bytes BLOB "
        "NOT NULL) STRICT; CREATE INDEX template_of_person ON template (person_id);"
        "INSERT INTO person VALUES (7, 'Wilhelmina', 1000, 5, 2000)");
    assert_int_equal(sqlite3_open(scratch_path(directory, "g.db"), &db), SQLITE_OK);
    assert_int_equal(
        sqlite3_prepare_v2(db, "INSERT INTO template VALUES (?1, 7, 81, ?2)", -1, &insert, NULL),
        SQLITE_OK);
    for (int i = 0; i < 2; i++) {
        bytes[4] = i == 0 ? ISO_TEMPLATE_VERSION : 9; /* the version of the template */
        assert_int_equal(sqlite3_bind_int(insert, 1, 3 + i), SQLITE_OK);
        assert_int_equal(sqlite3_bind_blob(insert, 2, bytes, size, SQLITE_STATIC), SQLITE_OK);
        assert_int_equal(sqlite3_step(insert), SQLITE_DONE);
        assert_int_equal(sqlite3_reset(insert), SQLITE_OK);
    }
    assert_int_equal(sqlite3_finalize(insert), SQLITE_OK);
    assert_int_equal(sqlite3_close(db), SQLITE_OK);
}

static void a_gallery_of_version_1_is_sealed_without_loss(void **state)
{
    size_t size = 0;
    make_version_1(*state);
    for (int i = 0; i < 2; i++) {
        struct iso_gallery *gallery = gallery_rig_open(*state);
        const struct iso_person *person = iso_gallery_find(gallery, "Wilhelmina");
        assert_non_null(person);
        assert_int_equal(person->id, 7);
        assert_int_equal(person->enrolled_s, 1000);
        assert_int_equal(person->valid_from_s, 5);
        assert_int_equal(person->valid_until_s, 2000);
        assert_int_equal(person->templates, 2); /* the template of a newer version is kept */
        assert_int_equal(person->usable, 1);
        assert_int_equal(puppet_face_of(iso_gallery_everybody(gallery).entries->tmpl), 20);
        iso_gallery_close(gallery);
    }
    char *file = scratch_read(scratch_path(*state, "g.db"), &size);
    assert_null(memmem(file, size, "Wilhelmina", 10));
    free(file);
    assert_false(scratch_exists(scratch_path(*state, "g.db.new")));
}

static void an_unsealed_gallery_is_not_taken_later(void **state)
{
    make_three(*state);
    (void)unlink(scratch_path(*state, "g.db"));
    make_version_1(*state);
    expect_refusal(*state, -ESTALE, "an unsealed gallery, where there was a sealed one");
    (void)unlink(scratch_path(*state, "g.db.anchor"));
    expect_refusal(*state, -ESTALE, "an unsealed gallery, where there was a sealed one");
}

static void an_unsealed_gallery_is_not_taken_against_the_configuration(void **state)
{
    struct iso_gallery *gallery = NULL;
    struct iso_fault fault = {.text = ""};
    struct iso_gallery_options options = stores_gallery(*state);
    make_version_1(*state);
    options.migrate = false;
    assert_int_equal(iso_gallery_open(&options, &gallery, &fault), -ESTALE);
    assert_non_null(strstr(fault.text, "and [seal] migrate = no does not accept it"));
    iso_gallery_close(gallery_rig_open(*state));
}

/* The state after a kill: the sealing was announced, and the old database is still there. */
static void sealing_that_was_killed_begins_again(void **state)
{
    make_version_1(*state);
    stores_copy_file(*state, "g.db", "version1");
    iso_gallery_close(gallery_rig_open(*state));
    stores_forget();
    stores_copy_file(*state, "version1", "g.db");
    struct iso_key_ring *ring = stores_ring(*state);
    struct iso_anchor *anchor = NULL;
    struct iso_anchor_state pending = {.value = 0};
    pending.extra[16] = 1;
    assert_int_equal(iso_anchor_make(scratch_path(*state, "g.db.anchor"), "gallery", ring, true,
                                     &pending, &anchor, NULL),
                     0);
    iso_anchor_close(anchor);
    struct iso_gallery *gallery = gallery_rig_open(*state);
    assert_int_equal(iso_gallery_find(gallery, "Wilhelmina")->usable, 1);
    iso_gallery_close(gallery);
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, stores_setup, stores_teardown)
    const struct CMUnitTest tests[] = {
        TEST(stolen_files_have_no_name_and_no_template),
        TEST(the_search_finds_a_name_in_plain_text),
        TEST(the_length_of_a_name_does_not_show),
        TEST(another_key_opens_nothing),
        TEST(exchanged_records_are_found),
        TEST(an_old_record_is_found),
        TEST(an_old_gallery_is_found),
        TEST(an_old_gallery_is_unreadable_after_a_rotation),
        TEST(anchors_can_be_sealed_anew),
        TEST(a_gallery_of_version_1_is_sealed_without_loss),
        TEST(an_unsealed_gallery_is_not_taken_later),
        TEST(an_unsealed_gallery_is_not_taken_against_the_configuration),
        TEST(sealing_that_was_killed_begins_again),
    };
    gallery_rig_capacity = 100;
    return cmocka_run_group_tests(tests, NULL, NULL);
}
