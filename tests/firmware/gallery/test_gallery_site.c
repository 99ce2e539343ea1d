/* A gallery whose metric adapts: which templates teach it stays what it was over a start, a
 * rotation of keys and new numbers. */
#include <errno.h>
#include <sqlite3.h>
#include <stdio.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "firmware/gallery/gallery.h"
#include "tests/firmware/rigs/gallery_rig.h"
#include "tests/firmware/rigs/puppets.h"
#include "tests/support/scratch.h"

static struct iso_gallery *open_gallery(const char *directory, const struct iso_metric *metric,
                                        bool adapt)
{
    struct iso_gallery_options options = stores_gallery(directory);
    struct iso_gallery *gallery = NULL;
    options.metric = metric;
    options.adapt = adapt;
    options.capacity = 8;
    assert_int_equal(iso_gallery_open(&options, &gallery, NULL), 0);
    return gallery;
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

static void expect_taken_back(struct iso_gallery *gallery,
                              int (*act)(struct iso_gallery *, size_t *, struct iso_fault *),
                              size_t expected)
{
    size_t n = 99;
    assert_int_equal(act(gallery, &n, NULL), 0);
    assert_int_equal(n, expected);
}

/* Ada, Ben and Cam, then a second template of Ada. Cam is removed, so that the enrolment of Cam is
 * passed over. */
static void it_rolls_back_enrolment_by_enrolment(void **state)
{
    struct iso_metric *metric = gallery_rig_new_metric();
    struct iso_gallery *gallery = open_gallery(*state, metric, true);
    assert_int_equal(gallery_rig_add(gallery, "ada", 20, NULL), 0);
    assert_int_equal(gallery_rig_add(gallery, "ben", 40, NULL), 0);
    assert_int_equal(gallery_rig_add(gallery, "cam", 60, NULL), 0);
    assert_int_equal(gallery_rig_add(gallery, "ada", 22, NULL), 0);
    assert_int_equal(iso_gallery_remove(gallery, "cam", NULL), 0);
    expect_taken_back(gallery, iso_gallery_roll_back_site, 1);
    iso_gallery_close(gallery);

    gallery = open_gallery(*state, metric, true);
    assert_int_equal(iso_gallery_site_excluded(gallery), 1);
    expect_taken_back(gallery, iso_gallery_roll_back_site, 1);
    assert_int_equal(iso_gallery_rotate(gallery, NULL, NULL), 0);
    expect_taken_back(gallery, iso_gallery_roll_back_site, 1);
    expect_taken_back(gallery, iso_gallery_roll_back_site, 0);
    assert_int_equal(iso_gallery_site_excluded(gallery), 3);
    assert_int_equal(iso_gallery_find(gallery, "ada")->usable, 2);
    iso_gallery_close(gallery);
    assert_int_equal(version_of(*state), ISO_GALLERY_SCHEMA_SITE);
    iso_metric_free(metric);
}

/* Ada gets another number when the learned template is deleted. Ben, enrolled later, teaches. */
static void people_with_new_numbers_stay_excluded(void **state)
{
    struct iso_metric *metric = gallery_rig_new_metric();
    struct iso_gallery *gallery = open_gallery(*state, metric, true);
    struct iso_template learned = puppet_template(22, PUPPET_ALGORITHM);
    size_t n = 0;
    learned.learned = true;
    assert_int_equal(gallery_rig_add(gallery, "ada", 20, NULL), 0);
    const struct iso_person ada = *iso_gallery_find(gallery, "ada");
    assert_int_equal(iso_gallery_add(gallery, &ada, &learned, NULL), 0);
    expect_taken_back(gallery, iso_gallery_reset_site, 2);
    expect_taken_back(gallery, iso_gallery_reset_site, 0);
    assert_int_equal(gallery_rig_add(gallery, "ben", 40, NULL), 0);
    assert_int_equal(iso_gallery_forget_learned(gallery, &n, NULL), 0);
    assert_int_equal(n, 1);
    assert_true(iso_gallery_find(gallery, "ada")->id != ada.id);
    assert_int_equal(iso_gallery_site_excluded(gallery), 1);
    expect_taken_back(gallery, iso_gallery_roll_back_site, 0);
    expect_taken_back(gallery, iso_gallery_reset_site, 1);
    iso_gallery_close(gallery);
    iso_metric_free(metric);
}

/* Of two people who come by import, one does not teach at the door that they come from. */
static void imported_people_stay_excluded(void **state)
{
    struct iso_metric *metric = gallery_rig_new_metric();
    struct iso_gallery *gallery = open_gallery(*state, metric, true);
    struct iso_gallery_item items[2] = {{.n = 1}, {.n = 1}};
    uint8_t bytes[2][ISO_TEMPLATE_BYTES_MAX];
    size_t added = 0;
    for (int i = 0; i < 2; i++) {
        const struct iso_template tmpl = puppet_template(40 + 20 * i, PUPPET_ALGORITHM);
        const int size = iso_template_serialise(&tmpl, bytes[i], sizeof bytes[i]);
        (void)snprintf(items[i].person.name, sizeof items[i].person.name, i ? "cam" : "ben");
        items[i].templates[0].algorithm = PUPPET_ALGORITHM;
        items[i].templates[0].bytes = bytes[i];
        items[i].templates[0].size = (size_t)size;
        items[i].templates[0].excluded = i == 1;
    }
    assert_int_equal(gallery_rig_add(gallery, "ada", 20, NULL), 0);
    assert_int_equal(iso_gallery_import(gallery, items, 2, false, NULL, &added, NULL), 0);
    assert_int_equal(added, 2);
    assert_int_equal(iso_gallery_site_excluded(gallery), 1);
    iso_gallery_close(gallery);

    gallery = open_gallery(*state, metric, true);
    assert_int_equal(iso_gallery_site_excluded(gallery), 1);
    expect_taken_back(gallery, iso_gallery_roll_back_site, 1); /* the import: ben */
    expect_taken_back(gallery, iso_gallery_roll_back_site, 1); /* ada */
    iso_gallery_close(gallery);
    iso_metric_free(metric);
}

/* Adds a person whose template was made before this sensor. */
static void add_before(struct iso_gallery *gallery, const char *name, int face, const char *sensor)
{
    struct iso_template tmpl = puppet_template(face, PUPPET_ALGORITHM);
    struct iso_person person = {.enrolled_s = 1};
    (void)snprintf(person.name, sizeof person.name, "%s", name);
    (void)snprintf(tmpl.sensor, sizeof tmpl.sensor, "%s", sensor);
    assert_int_equal(iso_gallery_add(gallery, &person, &tmpl, NULL), 0);
}

/* Ada and Cam were enrolled before one sensor, Ben before another. Deleting learned templates
 * reads the people anew from the database, as an import does. */
static void the_sensor_of_each_template_is_kept(void **state)
{
    struct iso_metric *metric = gallery_rig_new_metric();
    struct iso_gallery *gallery = open_gallery(*state, metric, true);
    struct iso_template learned = puppet_template(22, PUPPET_ALGORITHM);
    size_t n = 0;
    learned.learned = true;
    add_before(gallery, "ada", 20, "puppet");
    add_before(gallery, "ben", 40, "sock");
    add_before(gallery, "cam", 60, "puppet");
    assert_int_equal(iso_gallery_site_other(gallery), 0); /* not known yet */
    iso_gallery_set_sensor(gallery, "puppet");
    assert_int_equal(iso_gallery_site_other(gallery), 1);
    const struct iso_person ada = *iso_gallery_find(gallery, "ada");
    assert_int_equal(iso_gallery_add(gallery, &ada, &learned, NULL), 0);
    assert_int_equal(iso_gallery_forget_learned(gallery, &n, NULL), 0);
    assert_int_equal(n, 1);
    assert_int_equal(iso_gallery_site_other(gallery), 1);
    iso_gallery_close(gallery);
    gallery = open_gallery(*state, metric, true);
    iso_gallery_set_sensor(gallery, "sock");
    assert_int_equal(iso_gallery_site_other(gallery), 2);
    iso_gallery_close(gallery);
    iso_metric_free(metric);
}

static void a_gallery_that_does_not_adapt_keeps_its_version(void **state)
{
    struct iso_metric *metric = gallery_rig_new_metric();
    struct iso_gallery *gallery = open_gallery(*state, metric, false);
    size_t n = 0;
    assert_int_equal(gallery_rig_add(gallery, "ada", 20, NULL), 0);
    assert_int_equal(iso_gallery_reset_site(gallery, &n, NULL), -EINVAL);
    assert_int_equal(iso_gallery_roll_back_site(gallery, &n, NULL), -EINVAL);
    assert_int_equal(iso_gallery_site_excluded(gallery), 0);
    iso_gallery_close(gallery);
    assert_int_equal(version_of(*state), ISO_GALLERY_SCHEMA_SEALED);
    iso_metric_free(metric);
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, stores_setup, stores_teardown)
    const struct CMUnitTest tests[] = {
        TEST(it_rolls_back_enrolment_by_enrolment),
        TEST(people_with_new_numbers_stay_excluded),
        TEST(imported_people_stay_excluded),
        TEST(the_sensor_of_each_template_is_kept),
        TEST(a_gallery_that_does_not_adapt_keeps_its_version),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
