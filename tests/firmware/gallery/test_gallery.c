/* The gallery returns what was added, in memory and after a restart. */
#include <errno.h>
#include <sqlite3.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "firmware/gallery/gallery.h"
#include "tests/firmware/rigs/gallery_rig.h"
#include "tests/firmware/rigs/puppets.h"
#include "tests/support/scratch.h"

static void begins_empty_and_private(void **state)
{
    struct iso_gallery *gallery = gallery_rig_open(*state);
    struct stat status;
    size_t n_people = 1;
    (void)iso_gallery_people(gallery, &n_people);
    const struct iso_candidate_list all = iso_gallery_everybody(gallery);
    const struct iso_candidate_list one = iso_gallery_only(gallery, 1);
    assert_int_equal(n_people, 0);
    assert_true(iso_candidates_none(&all));
    assert_true(iso_candidates_none(&one));
    assert_null(iso_gallery_find(gallery, "anna"));
    assert_int_equal(stat(scratch_path(*state, "g.db"), &status), 0);
    assert_int_equal(status.st_mode & 0777, 0600);
    iso_gallery_close(gallery);
    iso_gallery_close(NULL);
}

/* Checks the people and templates of keeps_people_over_a_restart(), which calls this before and
 * after the restart. */
static void check_three(struct iso_gallery *gallery)
{
    size_t n_people = 0;
    const struct iso_person *people = iso_gallery_people(gallery, &n_people);
    const struct iso_candidate_list all = iso_gallery_everybody(gallery);
    assert_int_equal(n_people, 2);
    assert_string_equal(people[0].name, "anna");
    assert_string_equal(people[1].name, "Zo\xc3\xab");
    assert_int_equal(people[0].enrolled_s, 1020); /* the second template does not change this */
    assert_int_equal(people[0].valid_from_s, 0);
    assert_int_equal(people[0].valid_until_s, 2000);
    gallery_rig_expect(gallery, "anna", 2);
    gallery_rig_expect(gallery, "Zo\xc3\xab", 1);
    /* The templates of one person are side by side, though they were added in another order. */
    assert_int_equal(all.n_entries, 3);
    assert_int_equal(puppet_face_of(all.entries[0].tmpl), 20);
    assert_int_equal(puppet_face_of(all.entries[1].tmpl), 22);
    assert_int_equal(puppet_face_of(all.entries[2].tmpl), 60);
    assert_int_equal(all.entries[1].person, people[0].id);
}

static void keeps_people_over_a_restart(void **state)
{
    struct iso_gallery *gallery = gallery_rig_open(*state);
    assert_int_equal(gallery_rig_add_until(gallery, "anna", 20, 2000, NULL), 0);
    assert_int_equal(gallery_rig_add_until(gallery, "Zo\xc3\xab", 60, 2000, NULL), 0);
    assert_int_equal(gallery_rig_add_until(gallery, "anna", 22, 2000, NULL), 0);
    check_three(gallery);
    iso_gallery_close(gallery);
    gallery = gallery_rig_open(*state);
    check_three(gallery);
    iso_gallery_close(gallery);
}

static void a_template_is_as_it_was(void **state)
{
    const struct iso_template wanted = puppet_template(20, PUPPET_ALGORITHM);
    struct iso_gallery *gallery = gallery_rig_open(*state);
    assert_int_equal(gallery_rig_add(gallery, "anna", 20, NULL), 0);
    assert_memory_equal(iso_gallery_everybody(gallery).entries->tmpl, &wanted, sizeof wanted);
    iso_gallery_close(gallery);
    gallery = gallery_rig_open(*state);
    assert_memory_equal(iso_gallery_everybody(gallery).entries->tmpl, &wanted, sizeof wanted);
    iso_gallery_close(gallery);
}

static void deletes_a_person_whole(void **state)
{
    struct iso_fault fault = {.text = ""};
    struct iso_gallery *gallery = gallery_rig_open(*state);
    assert_int_equal(gallery_rig_add(gallery, "anna", 20, NULL), 0);
    assert_int_equal(gallery_rig_add(gallery, "bob", 60, NULL), 0);
    assert_int_equal(gallery_rig_add(gallery, "anna", 22, NULL), 0);
    const int64_t id = iso_gallery_find(gallery, "anna")->id;
    assert_int_equal(iso_gallery_remove(gallery, "anna", NULL), 0);
    assert_null(iso_gallery_find(gallery, "anna"));
    gallery_rig_expect(gallery, "bob", 1);
    assert_int_equal(iso_gallery_everybody(gallery).n_entries, 1);
    assert_int_equal(iso_gallery_remove(gallery, "anna", &fault), -ENOENT);
    assert_string_equal(fault.text, "anna: no such person");
    iso_gallery_close(gallery);

    gallery = gallery_rig_open(*state);
    assert_null(iso_gallery_find(gallery, "anna"));
    assert_int_equal(gallery_rig_add(gallery, "anna", 20, NULL), 0);
    assert_true(iso_gallery_find(gallery, "anna")->id > id); /* the number is not used again */
    iso_gallery_close(gallery);
}

/* Returns the sealed record of the first template, to be freed. */
static void *sealed_template(const char *directory, size_t *size)
{
    sqlite3 *db = NULL;
    sqlite3_stmt *query = NULL;
    assert_int_equal(sqlite3_open(scratch_path(directory, "g.db"), &db), SQLITE_OK);
    assert_int_equal(sqlite3_prepare_v2(db, "SELECT record FROM template", -1, &query, NULL), 0);
    assert_int_equal(sqlite3_step(query), SQLITE_ROW);
    *size = (size_t)sqlite3_column_bytes(query, 0);
    void *bytes = malloc(*size);
    assert_non_null(bytes);
    memcpy(bytes, sqlite3_column_blob(query, 0), *size);
    assert_int_equal(sqlite3_finalize(query), SQLITE_OK);
    assert_int_equal(sqlite3_close(db), SQLITE_OK);
    return bytes;
}

/* The file no longer has the sealed bytes of a deleted person. */
static void leaves_nothing_behind(void **state)
{
    struct iso_gallery *gallery = gallery_rig_open(*state);
    size_t size = 0, sealed_size = 0;
    assert_int_equal(gallery_rig_add(gallery, "Wilhelmina", 20, NULL), 0);
    iso_gallery_close(gallery);
    char *sealed = sealed_template(*state, &sealed_size);
    char *before = scratch_read(scratch_path(*state, "g.db"), &size);
    assert_non_null(memmem(before, size, sealed, 64));
    gallery = gallery_rig_open(*state);
    assert_int_equal(iso_gallery_remove(gallery, "Wilhelmina", NULL), 0);
    iso_gallery_close(gallery);
    char *after = scratch_read(scratch_path(*state, "g.db"), &size);
    for (size_t at = 0; at + 64 < sealed_size; at += 64) {
        assert_null(memmem(after, size, sealed + at, 32));
    }
    free(sealed);
    free(before);
    free(after);
}

static void refuses_more_than_its_capacity(void **state)
{
    struct iso_fault fault = {.text = ""};
    struct iso_gallery *gallery = gallery_rig_open(*state);
    assert_int_equal(gallery_rig_add(gallery, "anna", 20, NULL), 0);
    assert_int_equal(gallery_rig_add(gallery, "bob", 60, NULL), 0);
    assert_int_equal(gallery_rig_add(gallery, "eve", 100, NULL), 0);
    assert_int_equal(gallery_rig_add(gallery, "zac", 140, &fault), -EDQUOT);
    assert_string_equal(fault.text, "the gallery is full: 3 people");
    assert_int_equal(iso_gallery_room(gallery, "zac", 1, NULL), -EDQUOT);
    assert_int_equal(iso_gallery_room(gallery, "anna", 1, NULL), 0);
    for (int i = 1; i < ISO_GALLERY_TEMPLATES_MAX; i++) {
        assert_int_equal(gallery_rig_add(gallery, "anna", 20 + i, NULL), 0);
    }
    assert_int_equal(gallery_rig_add(gallery, "anna", 19, &fault), -EDQUOT);
    assert_string_equal(fault.text, "anna has 16 templates, the most that one person can have");
    gallery_rig_expect(gallery, "anna", 16);
    iso_gallery_close(gallery);
}

/* The templates of one enrolment are stored together. */
static void adds_all_templates_or_none(void **state)
{
    struct iso_fault fault = {.text = ""};
    struct iso_gallery *gallery = gallery_rig_open(*state);
    const struct iso_person anna = {.name = "anna"};
    struct iso_template templates[ISO_GALLERY_TEMPLATES_MAX + 1];
    const struct iso_template *all[ISO_GALLERY_TEMPLATES_MAX + 1];
    for (int i = 0; i <= ISO_GALLERY_TEMPLATES_MAX; i++) {
        templates[i] = puppet_template(20 + i, PUPPET_ALGORITHM);
        all[i] = &templates[i];
    }
    templates[2].points_mm[0][3][1][2] = 600;
    assert_int_equal(iso_gallery_add_all(gallery, &anna, all, 3, &fault), -EINVAL);
    assert_null(iso_gallery_find(gallery, "anna"));
    templates[2] = puppet_template(22, PUPPET_ALGORITHM);
    assert_int_equal(
        iso_gallery_add_all(gallery, &anna, all, ISO_GALLERY_TEMPLATES_MAX + 1, &fault), -EDQUOT);
    assert_int_equal(iso_gallery_add_all(gallery, &anna, all, 5, &fault), 0);
    gallery_rig_expect(gallery, "anna", 5);
    assert_int_equal(iso_gallery_room(gallery, "anna", 11, NULL), 0);
    assert_int_equal(iso_gallery_room(gallery, "anna", 12, &fault), -EDQUOT);
    assert_string_equal(fault.text,
                        "anna has 5 templates, and 12 more exceed the 16 that one person can have");
    assert_int_equal(iso_gallery_add_all(gallery, &anna, all + 5, 11, &fault), 0);
    iso_gallery_close(gallery);
    gallery = gallery_rig_open(*state);
    gallery_rig_expect(gallery, "anna", 16);
    iso_gallery_close(gallery);
}

static void refuses_bad_names_and_templates(void **state)
{
    struct iso_fault fault = {.text = ""};
    struct iso_gallery *gallery = gallery_rig_open(*state);
    struct iso_person person = {.name = "anna"};
    struct iso_template tmpl = puppet_template(20, PUPPET_ALGORITHM + 1);
    assert_int_equal(gallery_rig_add(gallery, "an\nna", 20, &fault), -EINVAL);
    assert_string_equal(fault.text, "the name holds a control character");
    assert_int_equal(iso_gallery_add(gallery, &person, &tmpl, &fault), -EINVAL);
    assert_string_equal(fault.text, "the template is of another algorithm");
    tmpl = puppet_template(20, PUPPET_ALGORITHM);
    tmpl.points_mm[0][3][1][2] = 600;
    assert_int_equal(iso_gallery_add(gallery, &person, &tmpl, &fault), -EINVAL);
    assert_string_equal(fault.text, "the template is out of range");
    assert_null(iso_gallery_find(gallery, "anna"));
    iso_gallery_close(gallery);
}

static void keeps_templates_of_another_algorithm(void **state)
{
    struct iso_gallery *gallery = gallery_rig_open(*state);
    assert_int_equal(gallery_rig_add(gallery, "anna", 20, NULL), 0);
    iso_gallery_close(gallery);

    struct iso_gallery_options options = stores_gallery(*state);
    options.algorithm++;
    assert_int_equal(iso_gallery_open(&options, &gallery, NULL), 0);
    const struct iso_person *person = iso_gallery_find(gallery, "anna");
    assert_int_equal(person->templates, 1);
    assert_int_equal(person->usable, 0);
    assert_int_equal(iso_gallery_everybody(gallery).n_entries, 0);
    iso_gallery_close(gallery);

    gallery = gallery_rig_open(*state);
    gallery_rig_expect(gallery, "anna", 1);
    iso_gallery_close(gallery);
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, stores_setup, stores_teardown)
    const struct CMUnitTest tests[] = {
        TEST(begins_empty_and_private),
        TEST(keeps_people_over_a_restart),
        TEST(a_template_is_as_it_was),
        TEST(deletes_a_person_whole),
        TEST(leaves_nothing_behind),
        TEST(refuses_more_than_its_capacity),
        TEST(adds_all_templates_or_none),
        TEST(refuses_bad_names_and_templates),
        TEST(keeps_templates_of_another_algorithm),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
