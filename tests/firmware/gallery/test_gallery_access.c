/* The access records of the gallery: kept over a start, a rotation of keys, new numbers and an
 * import; deleted with the person; and what somebody who writes the file can do to them. */
#include <errno.h>
#include <sqlite3.h>
#include <stdlib.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "firmware/gallery/gallery.h"
#include "tests/firmware/rigs/gallery_rig.h"
#include "tests/firmware/rigs/puppets.h"
#include "tests/support/scratch.h"

/* Longer than two parts of the database. */
enum { LONG = 2 * ISO_TEMPLATE_BYTES_MAX + 17 };

static int64_t id_of(struct iso_gallery *gallery, const char *name)
{
    const struct iso_person *person = iso_gallery_find(gallery, name);
    return person ? person->id : -1;
}

static void set(struct iso_gallery *gallery, const char *name, const char *text)
{
    const int64_t id = name ? id_of(gallery, name) : 0;
    assert_int_equal(iso_gallery_set_access(gallery, id, text, strlen(text), NULL), 0);
}

/* text NULL: there is no record. */
static void expect(struct iso_gallery *gallery, const char *name, const char *text)
{
    size_t size = 99;
    const void *bytes = iso_gallery_access(gallery, name ? id_of(gallery, name) : 0, &size);
    assert_int_equal(size, text ? strlen(text) : 0);
    if (text) {
        assert_memory_equal(bytes, text, size);
    } else {
        assert_null(bytes);
    }
}

static struct iso_gallery *reopen(const char *directory, struct iso_gallery *gallery)
{
    iso_gallery_close(gallery);
    return gallery_rig_open(directory);
}

static struct iso_gallery *make(const char *directory)
{
    struct iso_gallery *gallery = gallery_rig_open(directory);
    assert_int_equal(gallery_rig_add(gallery, "ada", 20, NULL), 0);
    assert_int_equal(gallery_rig_add(gallery, "ben", 40, NULL), 0);
    set(gallery, "ben", "ben may");
    set(gallery, "ada", "ada may");
    set(gallery, NULL, "the site");
    return gallery;
}

static void records_outlast_a_start_and_a_rotation(void **state)
{
    struct iso_gallery *gallery = make(*state);
    for (int round = 0; round < 3; round++) {
        expect(gallery, "ada", "ada may");
        expect(gallery, "ben", "ben may");
        expect(gallery, NULL, "the site");
        if (round == 1) {
            assert_int_equal(iso_gallery_rotate(gallery, NULL, NULL), 0);
        }
        gallery = reopen(*state, gallery);
    }
    set(gallery, "ada", "ada may more");
    set(gallery, NULL, "");
    expect(gallery, "ada", "ada may more");
    expect(gallery, NULL, NULL);
    gallery = reopen(*state, gallery);
    expect(gallery, "ada", "ada may more");
    expect(gallery, NULL, NULL);
    iso_gallery_close(gallery);
}

static void a_long_record_is_kept_in_parts(void **state)
{
    struct iso_gallery *gallery = make(*state);
    size_t size = 0;
    uint8_t *text = malloc(LONG);
    for (int i = 0; i < LONG; i++) {
        text[i] = (uint8_t)(i * 7 + i / 256);
    }
    assert_int_equal(iso_gallery_set_access(gallery, 0, text, LONG, NULL), 0);
    gallery = reopen(*state, gallery);
    const void *kept = iso_gallery_access(gallery, 0, &size);
    assert_int_equal(size, LONG);
    assert_memory_equal(kept, text, LONG);
    set(gallery, NULL, "short again");
    gallery = reopen(*state, gallery);
    expect(gallery, NULL, "short again");
    iso_gallery_close(gallery);
    free(text);
}

static void a_record_goes_with_its_person(void **state)
{
    struct iso_gallery *gallery = make(*state);
    const int64_t ada = id_of(gallery, "ada");
    assert_int_equal(iso_gallery_remove(gallery, "ada", NULL), 0);
    assert_int_equal(iso_gallery_set_access(gallery, ada, "x", 1, NULL), -ENOENT);
    assert_int_equal(gallery_rig_add(gallery, "ada", 20, NULL), 0);
    expect(gallery, "ada", NULL);
    gallery = reopen(*state, gallery);
    expect(gallery, "ada", NULL);
    expect(gallery, "ben", "ben may");
    iso_gallery_close(gallery);
}

/* Deleting a learned template gives Ada another number. */
static void a_record_follows_a_new_number(void **state)
{
    struct iso_gallery *gallery = make(*state);
    struct iso_template learned = puppet_template(22, PUPPET_ALGORITHM);
    size_t n = 0;
    learned.learned = true;
    const struct iso_person ada = *iso_gallery_find(gallery, "ada");
    assert_int_equal(iso_gallery_add(gallery, &ada, &learned, NULL), 0);
    assert_int_equal(iso_gallery_forget_learned(gallery, &n, NULL), 0);
    assert_int_equal(n, 1);
    assert_true(id_of(gallery, "ada") != ada.id);
    expect(gallery, "ada", "ada may");
    gallery = reopen(*state, gallery);
    expect(gallery, "ada", "ada may");
    expect(gallery, "ben", "ben may");
    iso_gallery_close(gallery);
}

static void a_record_that_is_too_long_is_refused(void **state)
{
    struct iso_gallery *gallery = make(*state);
    char *text = calloc(1, ISO_GALLERY_ACCESS_MAX + 1);
    struct iso_fault fault = {.text = ""};
    assert_int_equal(iso_gallery_set_access(gallery, 0, text, ISO_GALLERY_ACCESS_MAX + 1, &fault),
                     -EFBIG);
    assert_non_null(strstr(fault.text, "at most"));
    expect(gallery, NULL, "the site");
    free(text);
    iso_gallery_close(gallery);
}

static int version_of(const char *directory)
{
    sqlite3 *db = NULL;
    sqlite3_stmt *query = NULL;
    assert_int_equal(sqlite3_open(scratch_path(directory, "g.db"), &db), SQLITE_OK);
    assert_int_equal(sqlite3_prepare_v2(db, "PRAGMA user_version", -1, &query, NULL), SQLITE_OK);
    assert_int_equal(sqlite3_step(query), SQLITE_ROW);
    const int version = sqlite3_column_int(query, 0);
    (void)sqlite3_finalize(query);
    (void)sqlite3_close(db);
    return version;
}

/* A gallery keeps the version that earlier programs read until its first access record. */
static void the_version_says_that_there_are_records(void **state)
{
    struct iso_gallery *gallery = gallery_rig_open(*state);
    assert_int_equal(gallery_rig_add(gallery, "ada", 20, NULL), 0);
    assert_int_equal(iso_gallery_set_access(gallery, 0, NULL, 0, NULL), 0);
    gallery = reopen(*state, gallery);
    iso_gallery_close(gallery);
    assert_int_equal(version_of(*state), ISO_GALLERY_SCHEMA_SEALED);
    gallery = gallery_rig_open(*state);
    set(gallery, NULL, "the site");
    iso_gallery_close(gallery);
    assert_int_equal(version_of(*state), ISO_GALLERY_SCHEMA);
}

/* Ben's record in Ada's place, a record of the site as Ada's, a record or all of them gone. */
static void changed_records_are_found(void **state)
{
    static const char *const changes[] = {
        "UPDATE access SET record = (SELECT record FROM access WHERE part = 0 ORDER BY person_id "
        "DESC LIMIT 1) WHERE person_id = 1",
        "UPDATE access SET person_id = 77 WHERE person_id = 1",
        "DELETE FROM access WHERE person_id = 1",
        "DELETE FROM access WHERE person_id = 0",
        "DROP TABLE access",
        "DROP TABLE access; PRAGMA user_version = 2",
    };
    for (size_t i = 0; i < sizeof changes / sizeof *changes; i++) {
        struct iso_gallery *gallery = NULL;
        size_t size = 0;
        iso_gallery_close(make(*state));
        uint8_t *whole = (uint8_t *)scratch_read(scratch_path(*state, "g.db"), &size);
        assert_null(memmem(whole, size, "ada may", 7));
        free(whole);
        gallery_rig_execute(*state, changes[i]);
        if (gallery_rig_try_open(*state, &gallery, NULL) != -EBADMSG) {
            fail_msg("'%s' was not found", changes[i]);
        }
        assert_int_equal(stores_teardown(state), 0);
        assert_int_equal(stores_setup(state), 0);
    }
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, stores_setup, stores_teardown)
    const struct CMUnitTest tests[] = {
        TEST(records_outlast_a_start_and_a_rotation),
        TEST(a_long_record_is_kept_in_parts),
        TEST(a_record_goes_with_its_person),
        TEST(a_record_follows_a_new_number),
        TEST(a_record_that_is_too_long_is_refused),
        TEST(the_version_says_that_there_are_records),
        TEST(changed_records_are_found),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
