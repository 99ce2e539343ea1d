/* The real pipeline: its parts, its refusals of parts that are not valid, and one stored face. */
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "drivers/base/times.h"
#include "drivers/recording/recording.h"
#include "firmware/recognise/pipeline.h"
#include "tests/support/scratch.h"

#define HEAD   ISOTHERM_SOURCE_DIR "/core/data/head.model"
#define METRIC ISOTHERM_SOURCE_DIR "/core/data/face.metric"
#define COHORT ISOTHERM_SOURCE_DIR "/core/data/cohort.templates"

static struct iso_pipeline_options options(void)
{
    return (struct iso_pipeline_options){
        .head_path = HEAD,
        .method = ISO_METHOD_distance,
        .data_path = COHORT,
        .extract = iso_extract_options_default(),
        .match = iso_match_options_default(),
        .clock = iso_times_system().monotonic,
    };
}

static void expect_refusal(const struct iso_pipeline_options *wanted, int error, const char *text)
{
    struct iso_pipeline pipeline = {0};
    struct iso_fault fault = {.text = ""};
    assert_int_equal(iso_pipeline_open(wanted, &pipeline, &fault), error);
    if (!strstr(fault.text, text)) {
        fail_msg("'%s' does not say '%s'", fault.text, text);
    }
    assert_null(pipeline.ops);
    iso_pipeline_close(&pipeline);
}

static void names_files_that_do_not_exist(void **state)
{
    struct iso_pipeline_options wanted = options();
    (void)state;
    wanted.head_path = "/nonexistent/head.model";
    expect_refusal(&wanted, -ENOENT, "/nonexistent/head.model: No such file or directory");
    wanted = options();
    wanted.data_path = "/nonexistent/cohort";
    expect_refusal(&wanted, -ENOENT, "/nonexistent/cohort: No such file or directory");
    wanted.data_path = "/";
    expect_refusal(&wanted, -EISDIR, "/: is a directory, not a file");
}

/* Copies the beginning of a file to another place. */
static const char *cut(const char *directory, const char *path, size_t bytes_less)
{
    size_t size = 0;
    const char *copy = scratch_path(directory, "cut");
    void *bytes = scratch_read(path, &size);
    assert_true(size > bytes_less);
    scratch_write(copy, bytes, size - bytes_less);
    free(bytes);
    return copy;
}

static void refuses_damaged_files(void **state)
{
    struct iso_pipeline_options wanted = options();
    wanted.head_path = cut(*state, HEAD, 1);
    expect_refusal(&wanted, -EBADMSG, "/cut: ");
    wanted = options();
    wanted.data_path = cut(*state, COHORT, 100);
    expect_refusal(&wanted, -EBADMSG, "/cut: ");
    wanted.data_path = HEAD;
    expect_refusal(&wanted, -EBADMSG, "/head.model: ");
    char *longer = calloc(1, ISO_HEAD_BYTES_MAX + 1);
    assert_non_null(longer);
    scratch_write(scratch_path(*state, "longer"), longer, ISO_HEAD_BYTES_MAX + 1);
    free(longer);
    wanted = options();
    wanted.head_path = scratch_path(*state, "longer");
    expect_refusal(&wanted, -EFBIG, "/longer: longer than");
}

static void refuses_a_cohort_of_other_options(void **state)
{
    struct iso_pipeline_options wanted = options();
    (void)state;
    wanted.extract.t_mm2 += 1;
    expect_refusal(&wanted, -EINVAL, "made with another head model or other options");
}

static void refuses_a_metric_that_is_damaged_or_of_other_options(void **state)
{
    struct iso_pipeline_options wanted = options();
    wanted.method = ISO_METHOD_metric;
    wanted.data_path = "/nonexistent/metric";
    expect_refusal(&wanted, -ENOENT, "/nonexistent/metric: No such file or directory");
    wanted.data_path = cut(*state, METRIC, 100);
    expect_refusal(&wanted, -EBADMSG, "/cut: metric file: truncated");
    wanted.data_path = COHORT;
    expect_refusal(&wanted, -EBADMSG, "not a metric file");
    wanted.data_path = METRIC;
    wanted.extract.smoothing_mm += 1;
    expect_refusal(&wanted, -EINVAL, "made with another head model or other options");
}

static void refuses_options_out_of_range(void **state)
{
    struct iso_pipeline_options wanted = options();
    (void)state;
    wanted.extract.n_radii = 0;
    expect_refusal(&wanted, -EINVAL, "extractor: options out of range");
}

/* A person has only one template to open. */
static int open_template(void *owner, int64_t person, struct iso_template *out, int capacity,
                         int *n, struct iso_fault *fault)
{
    (void)fault;
    assert_int_equal(person, 31);
    assert_true(capacity >= 1);
    *out = *(const struct iso_template *)owner;
    *n = 1;
    return 0;
}

/* Searches among all people, in one person, and in a person who is not in the index: the scores
 * equal those of the templates. */
static void search_an_index(const struct iso_pipeline *pipeline, const struct iso_template *tmpl,
                            double score)
{
    const struct iso_metric *metric = pipeline->ops->metric(pipeline->self);
    struct iso_index *index = NULL;
    struct iso_metric_vector vector;
    struct iso_template empty = *tmpl;
    memset(empty.weight, 0, sizeof empty.weight);
    assert_int_equal(iso_metric_project(metric, tmpl, &vector), 0);
    assert_int_equal(iso_index_new(metric, &index), 0);
    assert_int_equal(iso_index_reserve(index, 1), 0);
    assert_int_equal(iso_index_put(index, 31, &vector), 0);
    for (int64_t person = 30; person <= 32; person++) {
        struct iso_template owner = *tmpl;
        const struct iso_candidate_list among = {.index = index,
                                                 .person = person == 30 ? 0 : person,
                                                 .templates = open_template,
                                                 .owner = &owner};
        struct iso_search_hit hit;
        int n = 77;
        assert_int_equal(pipeline->ops->search(pipeline->self, &among, tmpl, &hit, 1, &n), 0);
        assert_int_equal(n, person == 32 ? 0 : 1);
        assert_true(n == 0 || (hit.person == 31 && fabs(hit.score - score) < 1e-5));
        assert_true(n == 0 || isnan(hit.distance_mm));
        assert_int_equal(pipeline->ops->search(pipeline->self, &among, &empty, &hit, 1, &n),
                         -ENODATA);
    }
    iso_index_free(index);
}

static void recognise_a_stored_face(const char *metric_path)
{
    struct iso_pipeline_options wanted = options();
    struct iso_pipeline pipeline = {0};
    struct iso_fault fault = {.text = ""};
    struct iso_recording *recording = NULL;
    struct iso_frame *frame = NULL;
    struct iso_extraction extraction;
    if (metric_path) {
        wanted.method = ISO_METHOD_metric;
        wanted.data_path = metric_path;
    }
    if (iso_pipeline_open(&wanted, &pipeline, &fault)) {
        fail_msg("%s", fault.text);
    }
    assert_int_equal(
        iso_recording_open(ISOTHERM_SOURCE_DIR "/sim/stored/p01-enrol", &recording, NULL), 0);
    assert_int_equal(iso_recording_frame_new(recording, &frame), 0);
    assert_int_equal(iso_recording_read(recording, 0, frame, NULL), 0);
    assert_int_equal(
        pipeline.ops->extract(pipeline.self, frame, "longer-than-15-bytes", &extraction), 0);
    assert_int_equal(extraction.outcome, ISO_CAPTURE_OK);
    assert_string_equal(extraction.tmpl.sensor, "longer-than-15-");
    assert_int_equal(extraction.tmpl.algorithm, pipeline.ops->algorithm(pipeline.self));
    assert_true(pipeline.ops->model(pipeline.self) != 0);

    const struct iso_search_entry entries[] = {{.person = 31, .tmpl = &extraction.tmpl}};
    struct iso_search_hit hit;
    int n = 0;
    const struct iso_candidate_list among = {.entries = entries, .n_entries = 1};
    assert_int_equal(pipeline.ops->search(pipeline.self, &among, &extraction.tmpl, &hit, 1, &n), 0);
    assert_int_equal(n, 1);
    assert_int_equal(hit.person, 31);
    assert_true(metric_path ? hit.score > 4.0 : hit.distance_mm < 0.01);
    assert_int_equal(pipeline.ops->metric(pipeline.self) == NULL, metric_path == NULL);
    if (metric_path) {
        search_an_index(&pipeline, &extraction.tmpl, hit.score);
    }

    memset(frame->depth_mm, 0,
           (size_t)frame->width_px * (size_t)frame->height_px * sizeof *frame->depth_mm);
    assert_int_equal(pipeline.ops->extract(pipeline.self, frame, "", &extraction), 0);
    assert_int_equal(extraction.outcome, ISO_CAPTURE_NOBODY);
    frame->depth_mm[0] = -1;
    assert_int_equal(pipeline.ops->extract(pipeline.self, frame, "", &extraction), -EINVAL);

    iso_frame_free(frame);
    iso_recording_close(recording);
    iso_pipeline_close(&pipeline);
    iso_pipeline_close(&pipeline);
}

static void recognises_a_stored_face_by_metric(void **state)
{
    (void)state;
    recognise_a_stored_face(METRIC);
}

static void recognises_a_stored_face_by_distance(void **state)
{
    (void)state;
    recognise_a_stored_face(NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(names_files_that_do_not_exist),
        cmocka_unit_test_setup_teardown(refuses_damaged_files, scratch_setup, scratch_teardown),
        cmocka_unit_test(refuses_a_cohort_of_other_options),
        cmocka_unit_test(refuses_options_out_of_range),
        cmocka_unit_test_setup_teardown(refuses_a_metric_that_is_damaged_or_of_other_options,
                                        scratch_setup, scratch_teardown),
        cmocka_unit_test(recognises_a_stored_face_by_metric),
        cmocka_unit_test(recognises_a_stored_face_by_distance),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
