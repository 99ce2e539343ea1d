/* The gallery's data about people besides templates: names, which do not differ by case alone, and
 * limits of validity. They change in one transaction and are kept over a restart. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "firmware/gallery/gallery.h"
#include "firmware/gallery/gallery_db.h"
#include "tests/firmware/rigs/gallery_rig.h"
#include "tests/firmware/rigs/puppets.h"
#include "tests/firmware/rigs/rig.h"

static struct iso_gallery *open_again(struct iso_gallery *gallery, const char *directory)
{
    iso_gallery_close(gallery);
    return gallery_rig_open(directory);
}

/* Returns the face of the only template of a person, opened from the database. */
static int face_of(struct iso_gallery *gallery, const char *name)
{
    struct iso_template tmpl;
    int n = 0;
    const struct iso_person *person = iso_gallery_find(gallery, name);
    assert_non_null(person);
    assert_int_equal(iso_gallery_templates(gallery, person->id, &tmpl, 1, &n, NULL), 0);
    assert_int_equal(n, 1);
    return puppet_face_of(&tmpl);
}

/* ---- names ---- */

static void a_name_is_one_whatever_its_case(void **state)
{
    struct iso_gallery *gallery = gallery_rig_open(*state);
    size_t n = 0;
    assert_int_equal(gallery_rig_add(gallery, "Ada", 20, NULL), 0);
    assert_int_equal(gallery_rig_add(gallery, "aDA", 22, NULL), 0); /* the same person */
    for (int i = 0; i < 2; i++) {
        (void)iso_gallery_people(gallery, &n);
        assert_int_equal(n, 1);
        assert_string_equal(iso_gallery_find(gallery, "ADA")->name,
                            "Ada"); /* the first spelling is kept */
        assert_int_equal(iso_gallery_find(gallery, "ada")->templates, 2);
        assert_int_equal(iso_gallery_find(gallery, "ada")->enrolled_s, 1020);
        assert_int_equal(iso_gallery_same_names(gallery), 0);
        gallery = open_again(gallery, *state);
    }
    assert_int_equal(iso_gallery_remove(gallery, "ada", NULL), 0);
    assert_null(iso_gallery_find(gallery, "Ada"));
    iso_gallery_close(gallery);
}

static void a_person_is_renamed_for_good(void **state)
{
    struct iso_gallery *gallery = gallery_rig_open(*state);
    assert_int_equal(gallery_rig_add(gallery, "ada", 20, NULL), 0);
    assert_int_equal(gallery_rig_add(gallery, "bob", 60, NULL), 0);
    const int64_t id = iso_gallery_find(gallery, "ada")->id;
    const uint64_t changes = iso_gallery_version(gallery).changes;
    assert_int_equal(iso_gallery_rename(gallery, "ADA", "Ada Lovelace", NULL), 0);
    assert_int_equal(iso_gallery_version(gallery).changes, changes + 1); /* one change */
    for (int i = 0; i < 3; i++) {
        assert_null(iso_gallery_find(gallery, "ada"));
        assert_int_equal(iso_gallery_find(gallery, "ada lovelace")->id, id);
        assert_int_equal(iso_gallery_find(gallery, "Ada Lovelace")->enrolled_s, 1020);
        assert_int_equal(face_of(gallery, "Ada Lovelace"),
                         20); /* the template can still be opened */
        assert_int_equal(face_of(gallery, "bob"), 60);
        if (i == 1) {
            assert_int_equal(iso_gallery_rotate(gallery, NULL, NULL), 0);
        }
        gallery = open_again(gallery, *state);
    }
    iso_gallery_close(gallery);
}

static void a_shorter_name_leaves_nothing_of_the_old_one(void **state)
{
    struct iso_gallery *gallery = gallery_rig_open(*state);
    static const char nothing[ISO_PERSON_NAME_SIZE];
    assert_int_equal(gallery_rig_add(gallery, "ada lovelace", 20, NULL), 0);
    assert_int_equal(iso_gallery_rename(gallery, "ada lovelace", "ada", NULL), 0);
    const char *name = iso_gallery_find(gallery, "ada")->name;
    assert_memory_equal(name + strlen("ada"), nothing, ISO_PERSON_NAME_SIZE - strlen("ada"));
    iso_gallery_close(gallery);
}

static void the_spelling_can_be_changed(void **state)
{
    struct iso_gallery *gallery = gallery_rig_open(*state);
    assert_int_equal(gallery_rig_add(gallery, "ada", 20, NULL), 0);
    assert_int_equal(iso_gallery_rename(gallery, "ada", "Ada", NULL), 0);
    gallery = open_again(gallery, *state);
    assert_string_equal(iso_gallery_find(gallery, "ada")->name, "Ada");
    iso_gallery_close(gallery);
}

static void refuses_names_that_cannot_be_given(void **state)
{
    struct iso_fault fault = {.text = ""};
    struct iso_gallery *gallery = gallery_rig_open(*state);
    assert_int_equal(gallery_rig_add(gallery, "ada", 20, NULL), 0);
    assert_int_equal(gallery_rig_add(gallery, "Bob", 60, NULL), 0);
    assert_int_equal(iso_gallery_rename(gallery, "ada", "BOB", &fault), -EEXIST);
    assert_string_equal(fault.text, "somebody else is enrolled as Bob");
    assert_int_equal(iso_gallery_rename(gallery, "ada", "a\tb", &fault), -EINVAL);
    assert_string_equal(fault.text, "the name holds a control character");
    assert_int_equal(iso_gallery_rename(gallery, "zac", "eve", &fault), -ENOENT);
    assert_string_equal(fault.text, "zac: no such person");
    assert_non_null(iso_gallery_find(gallery, "ada"));
    iso_gallery_close(gallery);
}

/* ---- a gallery of an earlier version ---- */

static void put(struct iso_gallery_db *db, const char *name, int face)
{
    uint8_t bytes[ISO_TEMPLATE_BYTES_MAX];
    struct iso_person row = {.enrolled_s = face};
    int64_t number = 0;
    const struct iso_template tmpl = puppet_template(face, PUPPET_ALGORITHM);
    const int size = iso_template_serialise(&tmpl, bytes, sizeof bytes);
    assert_true(size > 0);
    (void)snprintf(row.name, sizeof row.name, "%s", name);
    assert_int_equal(iso_gallery_db_put_person(db, &row, &row.id, NULL), 0);
    assert_int_equal(iso_gallery_db_put_template(db, row.id, PUPPET_ALGORITHM, bytes, (size_t)size,
                                                 &number, NULL),
                     0);
}

/* A gallery with both Ada and ada. */
static struct iso_gallery *open_with_both(const char *directory)
{
    struct iso_gallery_db *db = NULL;
    const struct iso_gallery_options options = stores_gallery(directory);
    assert_int_equal(iso_gallery_db_open(&options, &db, NULL), 0);
    assert_int_equal(iso_gallery_db_begin(db, NULL), 0);
    put(db, "ada", 20);
    put(db, "Ada", 60);
    assert_int_equal(iso_gallery_db_end(db, 0, NULL), 0);
    iso_gallery_db_close(db);
    return gallery_rig_open(directory);
}

static void two_spellings_of_an_earlier_version_stay_two_people(void **state)
{
    struct iso_gallery *gallery = open_with_both(*state);
    assert_int_equal(iso_gallery_same_names(gallery), 1);
    assert_int_equal(face_of(gallery, "ada"), 20);
    assert_int_equal(face_of(gallery, "Ada"), 60);
    assert_int_equal(face_of(gallery, "ADA"), 20); /* the person who was enrolled first */
    assert_int_equal(gallery_rig_add(gallery, "Ada", 62, NULL), 0);
    assert_int_equal(iso_gallery_find(gallery, "Ada")->templates, 2);
    assert_int_equal(iso_gallery_find(gallery, "ada")->templates, 1);
    assert_int_equal(iso_gallery_rename(gallery, "Ada", "Ada B", NULL), 0);
    gallery = open_again(gallery, *state);
    assert_int_equal(iso_gallery_same_names(gallery), 0);
    assert_int_equal(iso_gallery_find(gallery, "ADA B")->templates, 2);
    assert_int_equal(face_of(gallery, "Ada"), 20);
    iso_gallery_close(gallery);
}

/* A gallery with a name that has an invisible character. An earlier version allowed this. */
static void an_invisible_character_of_an_earlier_version_stays(void **state)
{
    struct iso_gallery_db *db = NULL;
    const struct iso_gallery_options options = stores_gallery(*state);
    assert_int_equal(iso_gallery_db_open(&options, &db, NULL), 0);
    assert_int_equal(iso_gallery_db_begin(db, NULL), 0);
    put(db, "ada", 20);
    put(db, "A\u200bda", 60);
    put(db, "bo\u200bb", 80);
    assert_int_equal(iso_gallery_db_end(db, 0, NULL), 0);
    iso_gallery_db_close(db);
    struct iso_gallery *gallery = gallery_rig_open(*state);
    struct iso_fault fault = {.text = ""};
    assert_int_equal(iso_gallery_same_names(gallery), 1);
    assert_int_equal(face_of(gallery, "A\u200bda"), 60);
    assert_int_equal(face_of(gallery, "Bob"), 80); /* found by its visible characters */
    assert_int_equal(gallery_rig_add(gallery, "Bob", 82, NULL),
                     0); /* another template of the same person */
    assert_int_equal(gallery_rig_add(gallery, "ev\u200be", 30, &fault), -EINVAL);
    assert_string_equal(fault.text, "the name holds an invisible character");
    assert_int_equal(iso_gallery_rename(gallery, "ada", "ad\u2060a", &fault), -EINVAL);
    assert_int_equal(iso_gallery_rename(gallery, "A\u200bda", "Ada B", NULL), 0);
    assert_int_equal(iso_gallery_rename(gallery, "bob", "Bob", NULL), 0);
    gallery = open_again(gallery, *state);
    assert_int_equal(iso_gallery_same_names(gallery), 0);
    assert_string_equal(iso_gallery_find(gallery, "BOB")->name, "Bob");
    assert_int_equal(iso_gallery_find(gallery, "bob")->templates, 2);
    iso_gallery_close(gallery);
}

static void invisible_characters_are_not_imported(void **state)
{
    struct iso_gallery *gallery = gallery_rig_open(*state);
    struct iso_fault fault = {.text = ""};
    uint8_t bytes[ISO_TEMPLATE_BYTES_MAX];
    const struct iso_template tmpl = puppet_template(20, PUPPET_ALGORITHM);
    const int size = iso_template_serialise(&tmpl, bytes, sizeof bytes);
    struct iso_gallery_item item = {
        .person.name = "A\u200bda",
        .n = 1,
        .templates[0] = {.algorithm = PUPPET_ALGORITHM, .bytes = bytes, .size = (size_t)size}};
    size_t added = 0;
    assert_int_equal(iso_gallery_import(gallery, &item, 1, true, NULL, &added, &fault), -EINVAL);
    assert_string_equal(fault.text, "the name holds an invisible character");
    assert_null(iso_gallery_find(gallery, "ada"));
    iso_gallery_close(gallery);
}

/* The lines have no names, because the system's log is not sealed. */
static void the_daemon_warns_of_two_spellings(void **state)
{
    struct rig *rig = *state;
    iso_appliance_free(rig->appliance);
    iso_gallery_close(rig->gallery);
    rig->borrowed.gallery = rig->gallery = open_with_both(rig->directory);
    assert_int_equal(iso_appliance_new(&rig->borrowed, &rig->appliance), 0);
    rig_start(rig);
    assert_non_null(
        strstr(rig->warned, "names of enrolled people that look like another's: 1; isotherm list"));
    assert_null(strcasestr(rig->warned, "ada"));
}

/* To forget learned templates, the gallery replaces each person by an import of the same person. */
static void two_spellings_forget_learned_templates(void **state)
{
    struct iso_gallery *gallery = open_with_both(*state);
    size_t n = 0;
    struct iso_template learned = puppet_template(22, PUPPET_ALGORITHM);
    learned.learned = true;
    const struct iso_person ada = {.name = "ada"}, Ada = {.name = "Ada"};
    assert_int_equal(iso_gallery_add(gallery, &ada, &learned, NULL), 0);
    assert_int_equal(iso_gallery_add(gallery, &Ada, &learned, NULL), 0);
    assert_int_equal(iso_gallery_forget_learned(gallery, &n, NULL), 0);
    assert_int_equal(n, 2);
    assert_int_equal(face_of(gallery, "ada"), 20);
    assert_int_equal(face_of(gallery, "Ada"), 60);
    iso_gallery_close(gallery);
}

static void two_spellings_are_not_imported(void **state)
{
    struct iso_gallery *gallery = gallery_rig_open(*state);
    struct iso_fault fault = {.text = ""};
    uint8_t bytes[ISO_TEMPLATE_BYTES_MAX];
    const struct iso_template tmpl = puppet_template(20, PUPPET_ALGORITHM);
    const int size = iso_template_serialise(&tmpl, bytes, sizeof bytes);
    struct iso_gallery_item items[2] = {{.n = 1}, {.n = 1}};
    size_t added = 0;
    for (int i = 0; i < 2; i++) {
        (void)snprintf(items[i].person.name, sizeof items[i].person.name, i ? "ADA" : "Ada");
        items[i].templates[0].algorithm = PUPPET_ALGORITHM;
        items[i].templates[0].bytes = bytes;
        items[i].templates[0].size = (size_t)size;
    }
    assert_int_equal(iso_gallery_import(gallery, items, 2, true, NULL, &added, &fault), -EINVAL);
    assert_string_equal(fault.text, "ADA and Ada are one name: rename one of them");
    assert_int_equal(iso_gallery_import(gallery, items, 1, false, NULL, &added, NULL), 0);
    assert_int_equal(added, 1);
    assert_int_equal(iso_gallery_import(gallery, items + 1, 1, false, NULL, &added, NULL), 0);
    assert_int_equal(added, 0); /* the person was known */
    assert_int_equal(iso_gallery_import(gallery, items + 1, 1, true, NULL, &added, NULL), 0);
    assert_string_equal(iso_gallery_find(gallery, "ada")->name, "ADA");
    iso_gallery_close(gallery);
}

/* ---- limits ---- */

static void limits_are_changed_for_good(void **state)
{
    const struct iso_validity december = {1796083200, 1798761599}, none = {0};
    struct iso_gallery *gallery = gallery_rig_open(*state);
    assert_int_equal(gallery_rig_add(gallery, "ada", 20, NULL), 0);
    assert_int_equal(iso_gallery_set_validity(gallery, "Ada", &december, NULL), 0);
    for (int i = 0; i < 2; i++) {
        assert_int_equal(iso_gallery_find(gallery, "ada")->valid_from_s, 1796083200);
        assert_int_equal(iso_gallery_find(gallery, "ada")->valid_until_s, 1798761599);
        assert_int_equal(face_of(gallery, "ada"), 20);
        gallery = open_again(gallery, *state);
    }
    assert_int_equal(iso_gallery_set_validity(gallery, "ada", &none, NULL), 0);
    gallery = open_again(gallery, *state);
    assert_int_equal(iso_gallery_find(gallery, "ada")->valid_until_s, 0);
    iso_gallery_close(gallery);
}

static void refuses_limits_that_are_impossible(void **state)
{
    const struct iso_validity empty = {9, 9}, before = {-1, 0}, fine = {1, 2};
    struct iso_gallery *gallery = gallery_rig_open(*state);
    assert_int_equal(gallery_rig_add(gallery, "ada", 20, NULL), 0);
    assert_int_equal(iso_gallery_set_validity(gallery, "ada", &empty, NULL), -EINVAL);
    assert_int_equal(iso_gallery_set_validity(gallery, "ada", &before, NULL), -EINVAL);
    assert_int_equal(iso_gallery_set_validity(gallery, "bob", &fine, NULL), -ENOENT);
    assert_int_equal(iso_gallery_find(gallery, "ada")->valid_from_s, 0);
    iso_gallery_close(gallery);
}

static void nothing_changes_on_a_full_disk(void **state)
{
    const struct iso_validity fine = {1, 2};
    struct iso_fault fault = {.text = ""};
    struct iso_gallery *gallery = gallery_rig_open(*state);
    assert_int_equal(gallery_rig_add(gallery, "ada", 20, NULL), 0);
    rig_fill_disk();
    assert_true(iso_gallery_rename(gallery, "ada", "eve", &fault) < 0);
    assert_true(iso_gallery_set_validity(gallery, "ada", &fine, &fault) < 0);
    rig_free_disk();
    for (int i = 0; i < 2; i++) {
        assert_null(iso_gallery_find(gallery, "eve"));
        assert_int_equal(iso_gallery_find(gallery, "ada")->valid_until_s, 0);
        gallery = open_again(gallery, *state);
    }
    assert_int_equal(face_of(gallery, "ada"), 20);
    iso_gallery_close(gallery);
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, stores_setup, stores_teardown)
    const struct CMUnitTest tests[] = {
        TEST(a_name_is_one_whatever_its_case),
        TEST(a_person_is_renamed_for_good),
        TEST(a_shorter_name_leaves_nothing_of_the_old_one),
        TEST(the_spelling_can_be_changed),
        TEST(refuses_names_that_cannot_be_given),
        TEST(an_invisible_character_of_an_earlier_version_stays),
        TEST(invisible_characters_are_not_imported),
        TEST(two_spellings_of_an_earlier_version_stay_two_people),
        cmocka_unit_test_setup_teardown(the_daemon_warns_of_two_spellings, rig_setup, rig_teardown),
        TEST(two_spellings_forget_learned_templates),
        TEST(two_spellings_are_not_imported),
        TEST(limits_are_changed_for_good),
        TEST(refuses_limits_that_are_impossible),
        TEST(nothing_changes_on_a_full_disk),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
