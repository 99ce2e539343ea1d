/* The index of people by a metric that adapts to them: only people who were enrolled before the
 * running class of sensor teach it. */
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "firmware/site/site_index.h"
#include "tests/firmware/site/site_rig.h"

#define ASTRA SITE_RIG_SENSOR
#define OTHER "kinect2"

/* Of the people 0 to 7, those with an even number were enrolled before an Astra, and the others
 * before a Kinect. Person 4 has one template of a Kinect, the others of an Astra; person 7 has one
 * of an Astra, the others of a Kinect. */
static const char *sensor_of(int person, int i)
{
    const bool even = person % 2 == 0;
    const bool exception = (person == 4 || person == 7) && i == 1;
    return even != exception ? ASTRA : OTHER;
}

static struct iso_site_index *new_mixed(const struct iso_metric *metric)
{
    struct iso_site_index *site = site_rig_new_index(metric, true);
    for (int p = 0; p < PEOPLE; p++) {
        for (int i = 0; i < TEMPLATES; i++) {
            site_rig_add_template_of(site, metric, p, i, sensor_of(p, i));
        }
    }
    return site;
}

/* A site that has the templates of one class only; `without`: a person who is left out, or -1. */
static struct iso_site_index *new_pure(const struct iso_metric *metric, const char *sensor,
                                       int without)
{
    struct iso_site_index *site = site_rig_new_index(metric, true);
    for (int p = 0; p < PEOPLE; p++) {
        for (int i = 0; i < TEMPLATES; i++) {
            if (p != without && strcmp(sensor_of(p, i), sensor) == 0) {
                site_rig_add_template_of(site, metric, p, i, sensor);
            }
        }
    }
    return site;
}

/* Expects that both use the same metric, to the bit. Frees the second one. */
static void expect_the_metric_of(struct iso_site_index *site, struct iso_site_index *pure)
{
    assert_int_equal(iso_site_index_settle(site), 0);
    assert_int_equal(iso_site_index_settle(pure), 0);
    const struct iso_site_metric *own = iso_site_index_metric(site);
    const struct iso_site_metric *expected = iso_site_index_metric(pure);
    assert_non_null(own);
    assert_non_null(expected);
    assert_int_equal(own->people, expected->people);
    assert_int_equal(own->n_own, expected->n_own);
    assert_memory_equal(own->number, expected->number, (size_t)own->n_own * sizeof *own->number);
    assert_memory_equal(own->own, expected->own,
                        (size_t)own->n_own * DIMENSIONS * sizeof *own->own);
    assert_memory_equal(own->metric->between, expected->metric->between,
                        DIMENSIONS * sizeof(float));
    assert_memory_equal(own->turn, expected->turn, DIMENSIONS * DIMENSIONS * sizeof(float));
    assert_memory_equal(own->offset, expected->offset, DIMENSIONS * sizeof(float));
    const struct iso_site_summary one = iso_site_index_state(site).summary;
    const struct iso_site_summary other = iso_site_index_state(pure).summary;
    assert_int_equal(one.people, other.people);
    assert_int_equal(one.taught, other.taught);
    assert_memory_equal(&one.offset, &other.offset, sizeof one.offset);
    assert_memory_equal(&one.growth, &other.growth, sizeof one.growth);
    iso_site_index_free(pure);
}

/* How many of the people do not teach because of another sensor. */
static int count_other(const struct iso_site_index *site)
{
    int n = 0;
    for (int p = 0; p < PEOPLE + ISO_SITE_PEOPLE_MIN; p++) {
        n += iso_site_index_is_other(site, p);
    }
    return n;
}

/* Everybody is still compared, with all templates. */
static void expect_everybody(struct iso_site_index *site)
{
    struct iso_metric_vector found;
    for (int p = 0; p < PEOPLE; p++) {
        assert_int_equal(iso_site_index_person(site, p, &found), 0);
        assert_int_equal(found.n, TEMPLATES);
    }
}

static void a_mixed_gallery_teaches_as_the_templates_of_one_class_alone(void **state)
{
    const struct iso_metric *metric = *state;
    struct iso_site_index *site = new_mixed(metric);
    iso_site_index_set_sensor(site, ASTRA);
    expect_the_metric_of(site, new_pure(metric, ASTRA, -1));
    assert_int_equal(iso_site_index_state(site).summary.people, 5); /* 0, 2, 4, 6, and 7 */
    assert_int_equal(iso_site_index_state(site).summary.taught, 4);
    assert_int_equal(count_other(site), 3);
    assert_true(iso_site_index_is_other(site, 1) && !iso_site_index_is_other(site, 7));
    expect_everybody(site);
    iso_site_index_remove(site, 2);
    expect_the_metric_of(site, new_pure(metric, ASTRA, 2));
    iso_site_index_free(site);
}

static void another_sensor_switches_to_its_own_people(void **state)
{
    const struct iso_metric *metric = *state;
    struct iso_site_index *site = new_mixed(metric);
    iso_site_index_set_sensor(site, ASTRA);
    assert_int_equal(iso_site_index_settle(site), 0);
    assert_false(iso_site_is_provisional(iso_site_index_state(site)));
    iso_site_index_set_sensor(site, OTHER);
    assert_null(iso_site_index_metric(site)); /* what the first sensor taught ends at once */
    assert_true(iso_site_is_provisional(iso_site_index_state(site)));
    expect_the_metric_of(site, new_pure(metric, OTHER, -1));
    assert_int_equal(count_other(site), 3); /* 0, 2, 6 */
    expect_everybody(site);
    iso_site_index_set_sensor(site, ASTRA);
    expect_the_metric_of(site, new_pure(metric, ASTRA, -1));
    iso_site_index_free(site);
}

static void the_same_sensor_again_changes_nothing(void **state)
{
    const struct iso_metric *metric = *state;
    struct iso_site_index *site = new_mixed(metric);
    iso_site_index_set_sensor(site, ASTRA);
    assert_int_equal(iso_site_index_settle(site), 0);
    const struct iso_site_metric *before = iso_site_index_metric(site);
    iso_site_index_set_sensor(site, ASTRA);
    assert_ptr_equal(iso_site_index_metric(site), before);
    assert_false(iso_site_index_state(site).due);
    iso_site_index_free(site);
}

static void until_the_sensor_is_known_all_teach(void **state)
{
    const struct iso_metric *metric = *state;
    struct iso_site_index *site = new_mixed(metric);
    for (int round = 0; round < 2; round++) {
        assert_int_equal(iso_site_index_settle(site), 0);
        assert_int_equal(iso_site_index_state(site).summary.people, PEOPLE);
        assert_int_equal(count_other(site), 0);
        iso_site_index_set_sensor(site, ASTRA);
        iso_site_index_set_sensor(site, "");
    }
    iso_site_index_free(site);
}

/* The metric of a site that has one class of sensor is not computed anew when the sensor becomes
 * known. */
static void a_site_of_one_class_goes_on_when_the_sensor_is_known(void **state)
{
    const struct iso_metric *metric = *state;
    struct iso_site_index *site = new_pure(metric, ASTRA, -1);
    assert_int_equal(iso_site_index_settle(site), 0);
    const struct iso_site_metric *before = iso_site_index_metric(site);
    assert_non_null(before);
    iso_site_index_set_sensor(site, ASTRA);
    assert_ptr_equal(iso_site_index_metric(site), before);
    assert_false(iso_site_index_state(site).due);
    site_rig_add_template_of(site, metric, 1, 2, OTHER);
    expect_the_metric_of(site, new_pure(metric, ASTRA, -1));
    assert_int_equal(count_other(site), 1);
    iso_site_index_free(site);
}

/* People who are enrolled before a new sensor complete its class. */
static void too_few_people_of_a_class_leave_the_shipped_metric(void **state)
{
    const struct iso_metric *metric = *state;
    struct iso_site_index *site = new_mixed(metric);
    iso_site_index_set_sensor(site, "d435");
    for (int p = PEOPLE; p < PEOPLE + ISO_SITE_PEOPLE_MIN; p++) {
        assert_int_equal(iso_site_index_settle(site), 0);
        assert_true(iso_site_is_provisional(iso_site_index_state(site)));
        assert_int_equal(iso_site_index_state(site).summary.people, p - PEOPLE);
        assert_int_equal(count_other(site), PEOPLE);
        expect_everybody(site);
        site_rig_add_template_of(site, metric, p, 0, "d435");
    }
    assert_int_equal(iso_site_index_settle(site), 0);
    assert_false(iso_site_is_provisional(iso_site_index_state(site)));
    iso_site_index_free(site);
}

/* A template stores 15 bytes of the model. */
static void a_long_model_is_compared_as_templates_store_it(void **state)
{
    const struct iso_metric *metric = *state;
    struct iso_site_index *site = site_rig_new_index(metric, true);
    for (int p = 0; p < PEOPLE; p++) {
        site_rig_add_template_of(site, metric, p, 0, "abcdefghijklmno");
    }
    iso_site_index_set_sensor(site, "abcdefghijklmnopqrs");
    assert_int_equal(count_other(site), 0);
    iso_site_index_set_sensor(site, "abcdefghijklmn");
    assert_int_equal(count_other(site), PEOPLE);
    iso_site_index_free(site);
}

/* A template that an administrator has excluded does not teach, of whatever class it is, and its
 * person is not one of another sensor. */
static void excluded_templates_of_the_class_do_not_teach(void **state)
{
    const struct iso_metric *metric = *state;
    struct iso_site_index *site = new_mixed(metric);
    struct iso_site_record record = {.n_ranges = 0};
    iso_site_index_set_sensor(site, ASTRA);
    iso_site_record_exclude(&record, site_rig_number_of(2, 0), site_rig_number_of(3, 0));
    iso_site_index_set_record(site, &record);
    expect_the_metric_of(site, new_pure(metric, ASTRA, 2));
    assert_int_equal(count_other(site), 3);
    iso_site_index_free(site);
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, site_rig_set_up, site_rig_tear_down)
    const struct CMUnitTest tests[] = {
        TEST(a_mixed_gallery_teaches_as_the_templates_of_one_class_alone),
        TEST(another_sensor_switches_to_its_own_people),
        TEST(the_same_sensor_again_changes_nothing),
        TEST(a_site_of_one_class_goes_on_when_the_sensor_is_known),
        TEST(until_the_sensor_is_known_all_teach),
        TEST(too_few_people_of_a_class_leave_the_shipped_metric),
        TEST(a_long_model_is_compared_as_templates_store_it),
        TEST(excluded_templates_of_the_class_do_not_teach),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
