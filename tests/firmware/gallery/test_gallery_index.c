/* A gallery with a metric: the index of its vectors, and templates that are opened for one person
 * at a time. */
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

/* Expects the vector in the index of a person with templates of these faces. */
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
    struct iso_metric *metric = gallery_rig_new_metric();
    struct iso_gallery_options options = stores_gallery(*state);
    struct iso_gallery *gallery = NULL;
    options.metric = metric;
    assert_int_equal(iso_gallery_open(&options, &gallery, NULL), 0);
    assert_int_equal(gallery_rig_add(gallery, "anna", 20, NULL), 0);
    assert_int_equal(gallery_rig_add(gallery, "bob", 60, NULL), 0);
    assert_int_equal(gallery_rig_add(gallery, "anna", 22, NULL), 0);
    assert_int_equal(gallery_rig_add(gallery, "cleo", 70, NULL), 0);
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

/* Each person has their own vector and template, for any number of people. The arrays grow while a
 * database is read. */
static void each_number_of_people_is_read_whole(void **state)
{
    enum { PEOPLE = 34 };
    struct iso_metric *metric = gallery_rig_new_metric();
    struct iso_gallery_options options = stores_gallery(*state);
    struct iso_gallery *gallery = NULL;
    char name[PEOPLE][16];
    options.capacity = PEOPLE;
    for (int n = 1; n <= PEOPLE; n++) {
        (void)snprintf(name[n - 1], sizeof name[0], "person %d", n);
        options.metric = NULL;
        assert_int_equal(iso_gallery_open(&options, &gallery, NULL), 0);
        for (int i = 0; i < n - 1; i++) {
            gallery_rig_expect(gallery, name[i], 1);
        }
        assert_int_equal(gallery_rig_add(gallery, name[n - 1], n, NULL), 0);
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

/* A person with such a template is enrolled, but no search finds the person. */
static void a_template_without_points_is_in_no_index(void **state)
{
    struct iso_metric *metric = gallery_rig_new_metric();
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
    struct iso_gallery *gallery = gallery_rig_open(*state);
    struct iso_template found[3];
    struct iso_fault fault = {.text = ""};
    int n = 77;
    assert_int_equal(gallery_rig_add(gallery, "anna", 20, NULL), 0);
    assert_int_equal(gallery_rig_add(gallery, "bob", 60, NULL), 0);
    assert_int_equal(gallery_rig_add(gallery, "anna", 22, NULL), 0);
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
    assert_int_equal(iso_gallery_templates(gallery, anna, found, 1, &n, NULL),
                     0); /* the first one */
    assert_int_equal(n, 1);
    assert_int_equal(puppet_face_of(&found[0]), 20);
    n = 77;
    assert_int_equal(iso_gallery_templates(gallery, 99, found, 3, &n, &fault), -ENOENT);
    assert_string_equal(fault.text, "nobody has the number 99");
    assert_int_equal(n, 77);
    /* A person who was deleted after the search is nobody, and not a person without templates. */
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

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, stores_setup, stores_teardown)
    const struct CMUnitTest tests[] = {
        TEST(with_a_metric_it_keeps_an_index_of_vectors),
        TEST(each_number_of_people_is_read_whole),
        TEST(a_template_without_points_is_in_no_index),
        TEST(templates_are_opened_one_person_at_a_time),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
