/* The vectors that a gallery stores beside its templates, so that the next start need not make
 * them. Each test compares what a start finds with the vectors of the templates themselves. */
#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "core/base/crc32.h"
#include "firmware/gallery/gallery.h"
#include "tests/firmware/gallery/vectors_rig.h"
#include "tests/firmware/rigs/gallery_rig.h"
#include "tests/firmware/rigs/puppets.h"
#include "tests/support/scratch.h"

/* ---- what they are for ---- */

static void the_second_start_reads_no_template(void **state)
{
    const struct vectors_rig world = vectors_rig_new(state);
    vectors_rig_enroll(&world);
    struct iso_gallery *gallery = vectors_rig_open(&world);
    const struct iso_gallery_version before = iso_gallery_version(gallery);
    assert_int_equal(vectors_rig_n_parsed, VECTORS_RIG_PEOPLE);
    vectors_rig_expect_everybody(gallery, &world);
    iso_gallery_close(gallery);
    assert_int_equal(vectors_rig_ask(&world, "SELECT count(*) FROM vector"), VECTORS_RIG_PEOPLE);

    vectors_rig_expect_start(&world, 0);
    gallery = vectors_rig_open(&world);
    assert_int_equal(iso_gallery_version(gallery).changes, before.changes);
    iso_gallery_close(gallery);
    iso_metric_free(world.metric);
}

static void few_vectors_are_not_stored(void **state)
{
    const struct vectors_rig world = vectors_rig_new(state);
    struct iso_gallery *gallery = vectors_rig_open(&world);
    assert_int_equal(gallery_rig_add_number(gallery, 1, NULL), 0);
    iso_gallery_close(gallery);
    iso_gallery_close(vectors_rig_open(&world));
    assert_int_equal(
        vectors_rig_ask(&world, "SELECT count(*) FROM sqlite_schema WHERE name = 'vector'"), 0);
    iso_metric_free(world.metric);
}

/* Only new templates are read. */
static void people_who_came_later_are_made_at_the_start(void **state)
{
    const struct vectors_rig world = vectors_rig_new(state);
    vectors_rig_store(&world);
    struct iso_gallery *gallery = vectors_rig_open(&world);
    struct iso_person person = {.name = "person 7"};
    const struct iso_template tmpl = puppet_template(300, PUPPET_ALGORITHM);
    assert_int_equal(iso_gallery_add(gallery, &person, &tmpl, NULL), 0);
    assert_int_equal(gallery_rig_add_number(gallery, VECTORS_RIG_PEOPLE, NULL), 0);
    iso_gallery_close(gallery);
    gallery = vectors_rig_open(&world);
    assert_int_equal(vectors_rig_n_parsed, 2);
    for (int i = 0; i <= VECTORS_RIG_PEOPLE; i++) {
        vectors_rig_expect_vector(gallery, &world, i, i == 7 ? 300 : -1);
    }
    iso_gallery_close(gallery);
    iso_metric_free(world.metric);
}

static void a_vector_goes_with_its_template(void **state)
{
    const struct vectors_rig world = vectors_rig_new(state);
    vectors_rig_store(&world);
    struct iso_gallery *gallery = vectors_rig_open(&world);
    assert_int_equal(iso_gallery_remove(gallery, "person 5", NULL), 0);
    iso_gallery_close(gallery);
    assert_int_equal(vectors_rig_ask(&world, "SELECT count(*) FROM vector"),
                     VECTORS_RIG_PEOPLE - 1);
    gallery = vectors_rig_open(&world);
    assert_int_equal(vectors_rig_n_parsed, 0);
    assert_null(iso_gallery_find(gallery, "person 5"));
    iso_gallery_close(gallery);
    iso_metric_free(world.metric);
}

static void a_new_key_deletes_them(void **state)
{
    const struct vectors_rig world = vectors_rig_new(state);
    vectors_rig_store(&world);
    struct iso_gallery *gallery = vectors_rig_open(&world);
    assert_int_equal(iso_gallery_rotate(gallery, NULL, NULL), 0);
    iso_gallery_close(gallery);
    assert_int_equal(vectors_rig_ask(&world, "SELECT count(*) FROM vector"), 0);
    vectors_rig_expect_start(&world, VECTORS_RIG_PEOPLE);
    vectors_rig_expect_start(&world, 0);
    iso_metric_free(world.metric);
}

static void another_metric_makes_its_own(void **state)
{
    struct vectors_rig world = vectors_rig_new(state);
    vectors_rig_store(&world);
    world.metric->axis[3] = 0.5f;
    vectors_rig_expect_start(&world, VECTORS_RIG_PEOPLE);
    vectors_rig_expect_start(&world, 0);
    world.metric->weight_min = 0.125f;
    vectors_rig_expect_start(&world, VECTORS_RIG_PEOPLE);
    iso_metric_free(world.metric);
}

/* Vectors that an earlier program has stored are taken as they are. If this test fails because
 * vectors are computed in another way, the label of stored vectors (gallery_seal.c) needs the next
 * number, and the test the new checksum. */
static void a_new_way_of_making_vectors_needs_a_new_label(void **state)
{
#ifdef __FP_FAST_FMA
    (void)state;
    skip(); /* the compiler may join products and sums, which changes the last bits */
#else
    const struct vectors_rig world = vectors_rig_new(state);
    uint32_t sum = 0;
    for (int face = 0; face < VECTORS_RIG_PEOPLE; face++) {
        const struct iso_template tmpl = puppet_template(face, PUPPET_ALGORITHM);
        struct iso_metric_vector one;
        assert_int_equal(iso_metric_project(world.metric, &tmpl, &one), 0);
        sum = iso_crc32(sum, one.mean, VECTORS_RIG_DIMENSIONS * sizeof(float));
        sum = iso_crc32(sum, &one.scale, sizeof one.scale);
        sum = iso_crc32(sum, &one.step, sizeof one.step);
    }
    assert_int_equal(sum, 0x5cc8e469u);
    iso_metric_free(world.metric);
#endif
}

/* Without a metric templates are in memory, and vectors are left as they are. */
static void without_a_metric_they_are_not_used(void **state)
{
    struct vectors_rig world = vectors_rig_new(state);
    vectors_rig_store(&world);
    world.options.metric = NULL;
    struct iso_gallery *gallery = vectors_rig_open(&world);
    assert_int_equal(vectors_rig_n_parsed, VECTORS_RIG_PEOPLE);
    assert_int_equal(iso_gallery_everybody(gallery).n_entries, VECTORS_RIG_PEOPLE);
    iso_gallery_close(gallery);
    world.options.metric = world.metric;
    vectors_rig_expect_start(&world, 0);
    iso_metric_free(world.metric);
}

/* ---- what is damaged ---- */

/* Rows of templates that are not what was stored, although their vectors are sound. */
static void a_changed_template_is_found_in_spite_of_its_vector(void **state)
{
    static const char *const changes[] = {
        ("UPDATE template SET record = CAST(substr(record, 1, length(record) - 16) || "
         "zeroblob(16) AS BLOB) WHERE id = 20"),
        "UPDATE template SET record = (SELECT record FROM template WHERE id = 22) WHERE id = 20",
        "UPDATE template SET person_id = 3 WHERE id = 20",
        "UPDATE template SET algorithm = algorithm + 1 WHERE id = 20",
        "UPDATE template SET record = zeroblob(0) WHERE id = 20",
        "DELETE FROM vector WHERE id = 20; DELETE FROM template WHERE id = 20",
    };
    const struct vectors_rig world = vectors_rig_new(state);
    vectors_rig_store(&world);
    stores_copy_file(*state, "g.db", "sound");
    for (size_t i = 0; i < sizeof changes / sizeof *changes; i++) {
        struct iso_gallery *gallery = NULL;
        struct iso_fault fault = {.text = ""};
        gallery_rig_execute(*state, changes[i]);
        const int error = iso_gallery_open(&world.options, &gallery, &fault);
        const char *text = i + 1 < sizeof changes / sizeof *changes ? "the record of template 20"
                                                                    : "records are missing";
        if (error != -EBADMSG || !strstr(fault.text, text)) {
            fail_msg("%d, '%s' after %s", error, fault.text, changes[i]);
        }
        stores_copy_file(*state, "sound", "g.db");
    }
    vectors_rig_expect_start(&world, 0);
    iso_metric_free(world.metric);
}

/* It could be of somebody who was removed. */
static void a_vector_of_no_template_is_refused(void **state)
{
    struct vectors_rig world = vectors_rig_new(state);
    vectors_rig_store(&world);
    gallery_rig_execute(*state, "PRAGMA foreign_keys = OFF;"
                                "INSERT INTO vector SELECT 9999, record FROM vector WHERE id = 20");
    for (int i = 0; i < 2; i++) { /* with a metric, and without */
        struct iso_gallery *gallery = NULL;
        struct iso_fault fault = {.text = ""};
        world.options.metric = i == 0 ? world.metric : NULL;
        assert_int_equal(iso_gallery_open(&world.options, &gallery, &fault), -EBADMSG);
        assert_non_null(strstr(fault.text, "damaged (a stored vector belongs to no template)"));
    }
    iso_metric_free(world.metric);
}

/* Vectors that are damaged, exchanged or missing are made again; nothing else changes. */
static void a_changed_vector_is_not_used(void **state)
{
    static const struct {
        const char *sql;
        int made;
    } changes[] = {
        {"UPDATE vector SET record = CAST(substr(record, 1, length(record) - 16) || zeroblob(16) "
         "AS BLOB) WHERE id = 20",
         1},
        {"UPDATE vector SET record = (SELECT record FROM vector WHERE id = 22) WHERE id = 20", 1},
        {"UPDATE vector SET record = zeroblob(length(record)) WHERE id = 20", 1},
        {"UPDATE vector SET record = zeroblob(0) WHERE id = 20", 1},
        {"UPDATE vector SET record = zeroblob(100000) WHERE id = 20", 1},
        {"DELETE FROM vector WHERE id <= 20", 10},
    };
    const struct vectors_rig world = vectors_rig_new(state);
    vectors_rig_store(&world);
    stores_copy_file(*state, "g.db", "sound");
    for (size_t i = 0; i < sizeof changes / sizeof *changes; i++) {
        gallery_rig_execute(*state, changes[i].sql);
        vectors_rig_expect_start(&world, changes[i].made);
        stores_copy_file(*state, "sound", "g.db");
    }
    gallery_rig_execute(*state, "DROP TABLE vector");
    vectors_rig_expect_start(&world, VECTORS_RIG_PEOPLE);
    iso_metric_free(world.metric);
}

static void a_full_disk_stores_none(void **state)
{
    const struct vectors_rig world = vectors_rig_new(state);
    struct stat status;
    struct rlimit unlimited;
    vectors_rig_enroll(&world);
    assert_int_equal(stat(scratch_path(*state, "g.db"), &status), 0);
    assert_int_equal(getrlimit(RLIMIT_FSIZE, &unlimited), 0);
    const struct rlimit limit = {.rlim_cur = (rlim_t)status.st_size,
                                 .rlim_max = unlimited.rlim_max};
    assert_true(signal(SIGXFSZ, SIG_IGN) != SIG_ERR);
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &limit), 0);
    struct iso_gallery *gallery = vectors_rig_open(&world);
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &unlimited), 0);
    assert_int_equal(iso_gallery_state(gallery, NULL), 0);
    vectors_rig_expect_everybody(gallery, &world);
    assert_int_equal(gallery_rig_add_number(gallery, VECTORS_RIG_PEOPLE, NULL), 0);
    assert_int_equal(iso_gallery_remove(gallery, "person 120", NULL), 0);
    iso_gallery_close(gallery);
    vectors_rig_expect_start(&world, VECTORS_RIG_PEOPLE);
    vectors_rig_expect_start(&world, 0);
    iso_metric_free(world.metric);
}

/* ---- a thief ---- */

static void a_stolen_file_shows_no_vector(void **state)
{
    const struct vectors_rig world = vectors_rig_new(state);
    size_t size = 0;
    vectors_rig_store(&world);
    char *file = scratch_read(scratch_path(*state, "g.db"), &size);
    for (int i = 0; i < VECTORS_RIG_PEOPLE; i++) {
        const struct iso_template tmpl = puppet_template(i, PUPPET_ALGORITHM);
        struct iso_metric_vector one;
        assert_int_equal(iso_metric_project(world.metric, &tmpl, &one), 0);
        assert_null(memmem(file, size, one.mean, VECTORS_RIG_DIMENSIONS * sizeof(float)));
    }
    free(file);
    iso_metric_free(world.metric);
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, stores_setup, stores_teardown)
    const struct CMUnitTest tests[] = {
        TEST(the_second_start_reads_no_template),
        TEST(few_vectors_are_not_stored),
        TEST(people_who_came_later_are_made_at_the_start),
        TEST(a_vector_goes_with_its_template),
        TEST(a_new_key_deletes_them),
        TEST(another_metric_makes_its_own),
        TEST(a_new_way_of_making_vectors_needs_a_new_label),
        TEST(without_a_metric_they_are_not_used),
        TEST(a_changed_template_is_found_in_spite_of_its_vector),
        TEST(a_vector_of_no_template_is_refused),
        TEST(a_changed_vector_is_not_used),
        TEST(a_full_disk_stores_none),
        TEST(a_stolen_file_shows_no_vector),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
