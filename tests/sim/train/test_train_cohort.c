/* The shipped cohort fits the extractor, and its first templates equal those that the training
 * makes, except for rounding. The first test needs no data; the others need
 * ISOTHERM_SHARED/data/ict-face. */
#include <errno.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "core/base/bytes.h"
#include "core/match/cohort.h"
#include "core/match/distance.h"
#include "drivers/model/model_file.h"
#include "sim/train/metric/train_cohort.h"
#include "tests/support/scratch.h"
#include "tests/support/shared_data.h"

/* The working memory of registrations. */
static struct iso_icp_workspace registration;

#define DATA    ISOTHERM_SOURCE_DIR "/core/data"
#define SHIPPED DATA "/cohort.templates"

enum { PEOPLE = 8, AT_FIRST_TEMPLATE = 20 /* of the file: see core/match/cohort.h */ };

struct fixture {
    struct iso_head_model *model;
    struct sim_ict *ict; /* NULL: the data is missing */
    struct sim_train_cohort_options options;
};

static int setup(void **state)
{
    struct fixture *f = calloc(1, sizeof *f);
    struct iso_fault fault;
    if (!f || iso_head_model_load(DATA "/head.model", &f->model, &fault) != 0) {
        free(f);
        return -1;
    }
    const char *path = shared_data("data/ict-face");
    *state = f;
    if (scratch_exists(path) && sim_ict_load(path, &f->ict, &fault) != 0) {
        return -1;
    }
    /* Options as for the shipped file (sim/train/train.sh), but with fewer people. */
    f->options = (struct sim_train_cohort_options){
        .ict = f->ict,
        .model = f->model,
        .extract = iso_extract_options_default(),
        .n_sensors = 4,
        .sensors = {&sim_sensor_astra, &sim_sensor_d435, &sim_sensor_kinect2,
                    &sim_sensor_truedepth},
        .n_people = PEOPLE,
        .seed = 1,
    };
    return 0;
}

static int teardown(void **state)
{
    struct fixture *f = *state;
    iso_head_model_free(f->model);
    sim_ict_free(f->ict);
    free(f);
    return 0;
}

static void the_shipped_cohort_fits_the_extractor(void **state)
{
    struct fixture *f = *state;
    struct iso_cohort *cohort = NULL;
    struct iso_extractor *extractor = NULL;
    struct iso_fault fault;
    assert_int_equal(iso_cohort_load(SHIPPED, &cohort, &fault), 0);
    assert_int_equal(iso_extractor_new(f->model, &f->options.extract, &extractor), 0);
    assert_int_equal(iso_cohort_size(cohort), 64);
    assert_int_equal(iso_cohort_algorithm(cohort), iso_extractor_algorithm(extractor));
    iso_extractor_free(extractor);
    iso_cohort_free(cohort);
}

static struct iso_template *train(const struct fixture *f)
{
    struct iso_template *templates = NULL;
    struct sim_train_cohort_report report;
    struct iso_fault fault;
    assert_int_equal(sim_train_cohort(&f->options, &templates, &report, &fault), 0);
    assert_int_equal(report.n_people, PEOPLE);
    assert_true(report.n_frames >= PEOPLE);
    return templates;
}

/* The bytes may differ: the last digits of the heat solver depend on the machine's BLAS. */
static void training_makes_the_shipped_templates(void **state)
{
    struct fixture *f = *state;
    if (!f->ict) {
        skip();
        return;
    }
    struct iso_template *templates = train(f);
    struct iso_match_options match = iso_match_options_default();
    size_t size = 0;
    uint8_t *file = scratch_read(SHIPPED, &size);
    const uint8_t *p = file + AT_FIRST_TEMPLATE;
    for (int i = 0; i < PEOPLE; i++) {
        struct iso_template shipped;
        double same_mm, other_mm;
        assert_int_equal(iso_template_parse(p + 4, iso_get_u32(p), &shipped), 0);
        p += 4 + iso_get_u32(p);
        assert_string_equal(shipped.sensor, f->options.sensors[i % 4]->name);
        assert_string_equal(templates[i].sensor, shipped.sensor);
        assert_int_equal(
            iso_match_distance(&registration, &templates[i], &shipped, &match, &same_mm), 0);
        assert_true(same_mm < 0.05);
        assert_int_equal(iso_match_distance(&registration, &templates[(i + 1) % PEOPLE], &shipped,
                                            &match, &other_mm),
                         0);
        assert_true(other_mm > 0.3);
    }
    free(file);
    free(templates);
}

static void the_same_options_make_the_same_templates(void **state)
{
    struct fixture *f = *state;
    if (!f->ict) {
        skip();
        return;
    }
    struct iso_template *a = train(f), *b = train(f);
    assert_memory_equal(a, b, PEOPLE * sizeof *a);
    free(a);
    free(b);
}

static void refuses_options_out_of_range(void **state)
{
    struct fixture *f = *state;
    if (!f->ict) {
        skip();
        return;
    }
    struct iso_template *templates = NULL;
    struct sim_train_cohort_report report;
    struct iso_fault fault;
    struct sim_train_cohort_options bad[4];
    for (int i = 0; i < 4; i++) {
        bad[i] = f->options;
    }
    bad[0].n_people = ISO_COHORT_MIN - 1;
    bad[1].n_people = ISO_COHORT_MAX + 1;
    bad[2].n_sensors = 0;
    bad[3].n_sensors = SIM_COHORT_SENSORS_MAX + 1;
    for (int i = 0; i < 4; i++) {
        assert_int_equal(sim_train_cohort(&bad[i], &templates, &report, &fault), -EINVAL);
    }
    assert_null(templates);
}

/* The extraction accepts only faces at a distance of 9 m. No person stands there, so that no face
 * is accepted. */
static void says_when_hardly_anyone_is_accepted(void **state)
{
    struct fixture *f = *state;
    if (!f->ict) {
        skip();
        return;
    }
    struct iso_template *templates = NULL;
    struct sim_train_cohort_report report;
    struct iso_fault fault;
    struct sim_train_cohort_options options = f->options;
    options.n_sensors = 1;
    options.extract.distance_min_mm = 9000.0;
    options.extract.distance_max_mm = 9100.0;
    assert_int_equal(sim_train_cohort(&options, &templates, &report, &fault), -ENODATA);
    assert_non_null(strstr(fault.text, "too few faces"));
    assert_null(templates);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_shipped_cohort_fits_the_extractor),
        cmocka_unit_test(training_makes_the_shipped_templates),
        cmocka_unit_test(the_same_options_make_the_same_templates),
        cmocka_unit_test(refuses_options_out_of_range),
        cmocka_unit_test(says_when_hardly_anyone_is_accepted),
    };
    return cmocka_run_group_tests(tests, setup, teardown);
}
