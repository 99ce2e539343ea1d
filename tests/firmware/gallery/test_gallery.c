/* The gallery: what goes in comes out again, in memory and after a restart. */
#include <errno.h>
#include <sqlite3.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "firmware/gallery/gallery.h"
#include "tests/firmware/rigs/puppets.h"
#include "tests/firmware/rigs/stores.h"
#include "tests/support/scratch.h"

static struct iso_gallery *open_gallery(const char *directory)
{
    struct iso_gallery *gallery = NULL;
    struct iso_fault fault = {.text = ""};
    const struct iso_gallery_options options = stores_gallery(directory);
    if (iso_gallery_open(&options, &gallery, &fault)) {
        fail_msg("%s", fault.text);
    }
    return gallery;
}

static int add(struct iso_gallery *gallery, const char *name, int face, struct iso_fault *fault)
{
    struct iso_person person = {.enrolled_s = 1000 + face, .valid_until_s = 2000};
    const struct iso_template tmpl = puppet_template(face, PUPPET_ALGORITHM);
    (void)snprintf(person.name, sizeof person.name, "%s", name);
    return iso_gallery_add(gallery, &person, &tmpl, fault);
}

static void expect_person(struct iso_gallery *gallery, const char *name, unsigned templates)
{
    const struct iso_person *person = iso_gallery_find(gallery, name);
    assert_non_null(person);
    assert_int_equal(person->templates, templates);
    assert_int_equal(person->usable, templates);
    assert_ptr_equal(iso_gallery_find_id(gallery, person->id), person);
    assert_int_equal(iso_gallery_only(gallery, person->id).n_entries, templates);
}

static void begins_empty_and_private(void **state)
{
    struct iso_gallery *gallery = open_gallery(*state);
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

/* Everything the same before and after a restart. */
static void check_three(struct iso_gallery *gallery)
{
    size_t n_people = 0;
    const struct iso_person *people = iso_gallery_people(gallery, &n_people);
    const struct iso_candidate_list all = iso_gallery_everybody(gallery);
    assert_int_equal(n_people, 2);
    assert_string_equal(people[0].name, "anna");
    assert_string_equal(people[1].name, "Zo\xc3\xab");
    assert_int_equal(people[0].enrolled_s, 1020); /* the second template does not change that */
    assert_int_equal(people[0].valid_from_s, 0);
    assert_int_equal(people[0].valid_until_s, 2000);
    expect_person(gallery, "anna", 2);
    expect_person(gallery, "Zo\xc3\xab", 1);
    /* Those of one person side by side, though they came in another order. */
    assert_int_equal(all.n_entries, 3);
    assert_int_equal(puppet_face_of(all.entries[0].tmpl), 20);
    assert_int_equal(puppet_face_of(all.entries[1].tmpl), 22);
    assert_int_equal(puppet_face_of(all.entries[2].tmpl), 60);
    assert_int_equal(all.entries[1].person, people[0].id);
}

static void keeps_people_over_a_restart(void **state)
{
    struct iso_gallery *gallery = open_gallery(*state);
    assert_int_equal(add(gallery, "anna", 20, NULL), 0);
    assert_int_equal(add(gallery, "Zo\xc3\xab", 60, NULL), 0);
    assert_int_equal(add(gallery, "anna", 22, NULL), 0);
    check_three(gallery);
    iso_gallery_close(gallery);
    gallery = open_gallery(*state);
    check_three(gallery);
    iso_gallery_close(gallery);
}

static void a_template_is_as_it_was(void **state)
{
    const struct iso_template wanted = puppet_template(20, PUPPET_ALGORITHM);
    struct iso_gallery *gallery = open_gallery(*state);
    assert_int_equal(add(gallery, "anna", 20, NULL), 0);
    assert_memory_equal(iso_gallery_everybody(gallery).entries->tmpl, &wanted, sizeof wanted);
    iso_gallery_close(gallery);
    gallery = open_gallery(*state);
    assert_memory_equal(iso_gallery_everybody(gallery).entries->tmpl, &wanted, sizeof wanted);
    iso_gallery_close(gallery);
}

static void deletes_a_person_whole(void **state)
{
    struct iso_fault fault = {.text = ""};
    struct iso_gallery *gallery = open_gallery(*state);
    assert_int_equal(add(gallery, "anna", 20, NULL), 0);
    assert_int_equal(add(gallery, "bob", 60, NULL), 0);
    assert_int_equal(add(gallery, "anna", 22, NULL), 0);
    const int64_t id = iso_gallery_find(gallery, "anna")->id;
    assert_int_equal(iso_gallery_remove(gallery, "anna", NULL), 0);
    assert_null(iso_gallery_find(gallery, "anna"));
    expect_person(gallery, "bob", 1);
    assert_int_equal(iso_gallery_everybody(gallery).n_entries, 1);
    assert_int_equal(iso_gallery_remove(gallery, "anna", &fault), -ENOENT);
    assert_string_equal(fault.text, "anna: no such person");
    iso_gallery_close(gallery);

    gallery = open_gallery(*state);
    assert_null(iso_gallery_find(gallery, "anna"));
    assert_int_equal(add(gallery, "anna", 20, NULL), 0);
    assert_true(iso_gallery_find(gallery, "anna")->id > id); /* the number is not used again */
    iso_gallery_close(gallery);
}

/* The sealed record of the first template, to be freed. */
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

/* The bytes of whom it forgets are gone from the file, sealed as they were. */
static void leaves_nothing_behind(void **state)
{
    struct iso_gallery *gallery = open_gallery(*state);
    size_t size = 0, sealed_size = 0;
    assert_int_equal(add(gallery, "Wilhelmina", 20, NULL), 0);
    iso_gallery_close(gallery);
    char *sealed = sealed_template(*state, &sealed_size);
    char *before = scratch_read(scratch_path(*state, "g.db"), &size);
    assert_non_null(memmem(before, size, sealed, 64));
    gallery = open_gallery(*state);
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
    struct iso_gallery *gallery = open_gallery(*state);
    assert_int_equal(add(gallery, "anna", 20, NULL), 0);
    assert_int_equal(add(gallery, "bob", 60, NULL), 0);
    assert_int_equal(add(gallery, "eve", 100, NULL), 0);
    assert_int_equal(add(gallery, "zac", 140, &fault), -EDQUOT);
    assert_string_equal(fault.text, "the gallery is full: 3 people");
    assert_int_equal(iso_gallery_room(gallery, "zac", NULL), -EDQUOT);
    assert_int_equal(iso_gallery_room(gallery, "anna", NULL), 0);
    for (int i = 1; i < ISO_GALLERY_TEMPLATES_MAX; i++) {
        assert_int_equal(add(gallery, "anna", 20 + i, NULL), 0);
    }
    assert_int_equal(add(gallery, "anna", 19, &fault), -EDQUOT);
    assert_string_equal(fault.text, "anna has 16 templates, the most that one person can have");
    expect_person(gallery, "anna", 16);
    iso_gallery_close(gallery);
}

static void refuses_what_makes_no_sense(void **state)
{
    struct iso_fault fault = {.text = ""};
    struct iso_gallery *gallery = open_gallery(*state);
    struct iso_person person = {.name = "anna"};
    struct iso_template tmpl = puppet_template(20, PUPPET_ALGORITHM + 1);
    assert_int_equal(add(gallery, "an\nna", 20, &fault), -EINVAL);
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

/* A metric of the puppets' templates. */
static struct iso_metric *new_metric(void)
{
    const struct iso_template any = puppet_template(20, PUPPET_ALGORITHM);
    const struct iso_metric shape = {
        .algorithm = PUPPET_ALGORITHM,
        .landmarks = 3,
        .n_radii = any.n_radii,
        .n_points = any.n_points,
        .n_dimensions = 5,
        .weight_min = 0.25f,
        .gain = 1.0f,
    };
    struct iso_metric *metric = NULL;
    assert_int_equal(iso_metric_new(&shape, &metric), 0);
    for (int v = 0; v < metric->n_values; v++) {
        metric->curve_mm[v] = (float)((v * 37) % 11);
        metric->axis[v * 5 + v % 5] = 1.0f;
    }
    for (int d = 0; d < 5; d++) {
        metric->between[d] = 2.0f;
    }
    return metric;
}

/* The vector that the index has to have for somebody with templates of these faces. */
static void expect_vector(struct iso_gallery *gallery, const struct iso_metric *metric,
                          const char *name, const int *faces, int n)
{
    const struct iso_person *person = iso_gallery_find(gallery, name);
    struct iso_metric_vector all = {.n = 0}, one, found;
    for (int i = 0; i < n; i++) {
        const struct iso_template tmpl = puppet_template(faces[i], PUPPET_ALGORITHM);
        assert_int_equal(iso_metric_project(metric, &tmpl, &one), 0);
        iso_metric_vector_add(metric, &one, &all);
    }
    const struct iso_candidate_list own = iso_gallery_only(gallery, person->id);
    assert_int_equal(own.person, person->id);
    assert_int_equal(iso_index_find(own.index, person->id, &found), 0);
    assert_int_equal(found.n, n);
    assert_memory_equal(found.mean, all.mean, 5 * sizeof(float));
    assert_int_equal(person->usable, n);
}

static void expect_index(struct iso_gallery *gallery, const struct iso_metric *metric)
{
    static const int annas[] = {20, 22}, bobs[] = {60};
    const struct iso_candidate_list all = iso_gallery_everybody(gallery);
    assert_non_null(all.index);
    assert_int_equal(all.person, 0);
    assert_int_equal(all.n_entries, 0);
    assert_int_equal(iso_index_size(all.index), 2);
    expect_vector(gallery, metric, "anna", annas, 2);
    expect_vector(gallery, metric, "bob", bobs, 1);
}

static void with_a_metric_it_keeps_an_index_of_vectors(void **state)
{
    struct iso_metric *metric = new_metric();
    struct iso_gallery_options options = stores_gallery(*state);
    struct iso_gallery *gallery = NULL;
    options.metric = metric;
    assert_int_equal(iso_gallery_open(&options, &gallery, NULL), 0);
    assert_int_equal(add(gallery, "anna", 20, NULL), 0);
    assert_int_equal(add(gallery, "bob", 60, NULL), 0);
    assert_int_equal(add(gallery, "anna", 22, NULL), 0);
    assert_int_equal(add(gallery, "cleo", 70, NULL), 0);
    const int64_t cleo = iso_gallery_find(gallery, "cleo")->id;
    assert_int_equal(iso_gallery_remove(gallery, "cleo", NULL), 0);
    const struct iso_candidate_list gone = iso_gallery_only(gallery, cleo);
    assert_true(iso_candidates_none(&gone));
    expect_index(gallery, metric);
    iso_gallery_close(gallery);

    assert_int_equal(iso_gallery_open(&options, &gallery, NULL), 0);
    expect_index(gallery, metric);
    iso_gallery_close(gallery);
    iso_metric_free(metric);
}

/* Everybody with their own vector or template, whatever the number of people: arrays grow while
 * a database is read. */
static void each_number_of_people_is_read_whole(void **state)
{
    enum { PEOPLE = 34 };
    struct iso_metric *metric = new_metric();
    struct iso_gallery_options options = stores_gallery(*state);
    struct iso_gallery *gallery = NULL;
    char name[PEOPLE][16];
    options.capacity = PEOPLE;
    for (int n = 1; n <= PEOPLE; n++) {
        (void)snprintf(name[n - 1], sizeof name[0], "person %d", n);
        options.metric = NULL;
        assert_int_equal(iso_gallery_open(&options, &gallery, NULL), 0);
        for (int i = 0; i < n - 1; i++) {
            expect_person(gallery, name[i], 1);
        }
        assert_int_equal(add(gallery, name[n - 1], n, NULL), 0);
        iso_gallery_close(gallery);

        options.metric = metric;
        assert_int_equal(iso_gallery_open(&options, &gallery, NULL), 0);
        assert_int_equal(iso_index_size(iso_gallery_everybody(gallery).index), n);
        for (int i = 0; i < n; i++) {
            expect_vector(gallery, metric, name[i], &(int){i + 1}, 1);
        }
        iso_gallery_close(gallery);
    }
    iso_metric_free(metric);
}

/* They are enrolled, and nobody is like them. */
static void a_template_without_points_is_in_no_index(void **state)
{
    struct iso_metric *metric = new_metric();
    struct iso_gallery_options options = stores_gallery(*state);
    struct iso_gallery *gallery = NULL;
    const struct iso_person anna = {.name = "anna"};
    struct iso_template tmpl = puppet_template(20, PUPPET_ALGORITHM);
    memset(tmpl.weight, 0, sizeof tmpl.weight);
    options.metric = metric;
    for (int i = 0; i < 2; i++) {
        assert_int_equal(iso_gallery_open(&options, &gallery, NULL), 0);
        if (i == 0) {
            assert_int_equal(iso_gallery_add(gallery, &anna, &tmpl, NULL), 0);
        }
        assert_int_equal(iso_gallery_find(gallery, "anna")->usable, 1);
        assert_int_equal(iso_index_size(iso_gallery_everybody(gallery).index), 0);
        iso_gallery_close(gallery);
    }
    assert_int_equal(iso_gallery_open(&options, &gallery, NULL), 0);
    assert_int_equal(iso_gallery_remove(gallery, "anna", NULL), 0);
    iso_gallery_close(gallery);
    iso_metric_free(metric);
}

static void templates_are_opened_one_person_at_a_time(void **state)
{
    struct iso_gallery *gallery = open_gallery(*state);
    struct iso_template found[3];
    struct iso_fault fault = {.text = ""};
    int n = 77;
    assert_int_equal(add(gallery, "anna", 20, NULL), 0);
    assert_int_equal(add(gallery, "bob", 60, NULL), 0);
    assert_int_equal(add(gallery, "anna", 22, NULL), 0);
    const int64_t anna = iso_gallery_find(gallery, "anna")->id;
    const int64_t bob = iso_gallery_find(gallery, "bob")->id;
    assert_int_equal(iso_gallery_templates(gallery, anna, found, 3, &n, NULL), 0);
    assert_int_equal(n, 2);
    const struct iso_template wanted[] = {puppet_template(20, PUPPET_ALGORITHM),
                                          puppet_template(22, PUPPET_ALGORITHM)};
    assert_memory_equal(found, wanted, sizeof wanted);
    assert_int_equal(iso_gallery_templates(gallery, bob, found, 3, &n, NULL), 0);
    assert_int_equal(n, 1);
    assert_int_equal(puppet_face_of(&found[0]), 60);
    assert_int_equal(iso_gallery_templates(gallery, anna, found, 1, &n, NULL), 0); /* the first */
    assert_int_equal(n, 1);
    assert_int_equal(puppet_face_of(&found[0]), 20);
    n = 77;
    assert_int_equal(iso_gallery_templates(gallery, 99, found, 3, &n, &fault), -ENOENT);
    assert_string_equal(fault.text, "nobody has the number 99");
    assert_int_equal(n, 77);
    /* Gone since somebody searched: nobody, not a person without templates. */
    assert_int_equal(iso_gallery_remove(gallery, "bob", NULL), 0);
    assert_int_equal(iso_gallery_templates(gallery, bob, found, 3, &n, &fault), -ENOENT);
    assert_int_equal(n, 77);
    iso_gallery_close(gallery);

    struct iso_gallery_options options = stores_gallery(*state);
    options.algorithm++;
    assert_int_equal(iso_gallery_open(&options, &gallery, NULL), 0);
    assert_int_equal(iso_gallery_templates(gallery, anna, found, 3, &n, NULL), 0);
    assert_int_equal(n, 0); /* of another algorithm */
    iso_gallery_close(gallery);
}

static void keeps_templates_of_another_algorithm(void **state)
{
    struct iso_gallery *gallery = open_gallery(*state);
    assert_int_equal(add(gallery, "anna", 20, NULL), 0);
    iso_gallery_close(gallery);

    struct iso_gallery_options options = stores_gallery(*state);
    options.algorithm++;
    assert_int_equal(iso_gallery_open(&options, &gallery, NULL), 0);
    const struct iso_person *person = iso_gallery_find(gallery, "anna");
    assert_int_equal(person->templates, 1);
    assert_int_equal(person->usable, 0);
    assert_int_equal(iso_gallery_everybody(gallery).n_entries, 0);
    iso_gallery_close(gallery);

    gallery = open_gallery(*state);
    expect_person(gallery, "anna", 1);
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
        TEST(refuses_what_makes_no_sense),
        TEST(keeps_templates_of_another_algorithm),
        TEST(with_a_metric_it_keeps_an_index_of_vectors),
        TEST(each_number_of_people_is_read_whole),
        TEST(a_template_without_points_is_in_no_index),
        TEST(templates_are_opened_one_person_at_a_time),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
