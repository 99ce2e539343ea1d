/* The whole evaluation on a few stored recordings, and each file that it writes. */
#include <errno.h>
#include <jansson.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "drivers/model/model_file.h"
#include "sim/lab/report/report.h"
#include "tests/support/scratch.h"
#include "tests/support/stored_corpus.h"

#define STORED ISOTHERM_SOURCE_DIR "/sim/stored"
#define MODEL  ISOTHERM_SOURCE_DIR "/core/data/head.model"
#define METRIC ISOTHERM_SOURCE_DIR "/core/data/face.metric"
#define COHORT ISOTHERM_SOURCE_DIR "/core/data/cohort.templates"

static const char manifest[] = STORED_CORPUS_HEADER "p01-enrol,0,2,p01,e,gallery,,,\n"
                                                    "p02-enrol,1,2,p02,e,gallery,,,\n"
                                                    "p01-v1,0,2,p01,v1,probe,,mild,\n"
                                                    "p02-v1,1,1,p02,v1,probe,,mild,\n"
                                                    "x01-v1,0,1,x01,v1,impostor,,,\n"
                                                    "none-nobody1,0,1,none,n,impostor,,,nobody\n";

/* A corpus of links to stored recordings. */
static int setup(void **state)
{
    int error = scratch_setup(state);
    if (!error) {
        stored_corpus_make(*state, manifest);
    }
    return error;
}

static struct sim_eval_options options_for(const char *directory)
{
    return (struct sim_eval_options){
        .corpus = directory,
        .model = MODEL,
        .threads = 2,
        .extract = iso_extract_options_default(),
        .match = iso_match_options_default(),
    };
}

static struct sim_eval *evaluate(const struct sim_eval_options *options)
{
    struct sim_eval *eval = NULL;
    struct iso_fault fault = {.text = ""};
    if (sim_eval_run(options, &eval, &fault)) {
        fail_msg("%s", fault.text);
    }
    return eval;
}

static void test_figures(void **state)
{
    struct sim_eval_options options = options_for(*state);
    struct sim_eval *eval = evaluate(&options);
    const struct sim_analysis *a = eval->analysis;
    assert_int_equal(eval->acquisition->n_captures, 9);
    assert_int_equal(eval->acquisition->n_samples, 6);
    assert_int_equal(eval->gallery->n_people, 2);
    assert_int_equal(eval->gallery->templates[0]->n_frames, 2); /* fused */
    assert_int_equal(a->verification.scores.n_mated, 2);
    assert_int_equal(a->verification.scores.n_non_mated, 4);
    assert_int_equal(sim_rank_rate(a->identification.searches, 2, 1).events, 2);
    assert_int_equal(a->probe_reason[SIM_PROBE_NONE][ISO_CAPTURE_OK], 0);
    const struct sim_landmark_error *nose = &eval->landmarks[ISO_LM_NOSE_TIP];
    assert_int_equal(nose->error_mm.n, 8);
    assert_true(nose->error_mm.mean < 10.0);
    assert_true(nose->centred_error_mm.mean > 0.0);
    assert_int_equal(nose->slip_mm.n, 2 * 2 + 2 * 1); /* of p01 and of p02 */
    assert_int_equal(eval->landmarks[ISO_LANDMARKS].error_mm.n, 12 * 8);
    sim_eval_free(eval);
}

static void test_fuse_and_gallery_limit(void **state)
{
    struct sim_eval_options options = options_for(*state);
    options.fuse = 1;
    options.gallery_limit = 1;
    options.threads = 1;
    struct sim_eval *eval = evaluate(&options);
    assert_int_equal(eval->acquisition->n_samples, 9);
    assert_int_equal(eval->gallery->n_people, 1);
    assert_int_equal(eval->gallery->n_templates, 2);
    /* p02 is not enrolled and is therefore a stranger. */
    assert_int_equal(eval->analysis->n_kind[SIM_PROBE_MATED], 2);
    assert_int_equal(eval->analysis->n_kind[SIM_PROBE_STRANGER], 2);
    sim_eval_free(eval);
}

/* Rows of an enrolment in other poses are searches, are left out, or are enrolled. The row of
 * another expression, of another session or of another person is always a search. */
static void test_poses_of_an_enrolment(void **state)
{
    static const char poses[] = STORED_CORPUS_HEADER "p01-enrol,0,1,p01,e,gallery,ahead,neutral,\n"
                                                     "p02-enrol,0,1,p02,e,gallery,ahead,neutral,\n"
                                                     "p01-enrol,1,1,p01,e,probe,left,neutral,\n"
                                                     "p01-enrol,2,1,p01,e,probe,ahead,neutral,\n"
                                                     "p01-enrol,3,1,p01,e,probe,left,smile,\n"
                                                     "p01-v1,0,1,p01,v1,probe,left,neutral,\n"
                                                     "x01-v1,0,1,x01,e,impostor,left,neutral,\n";
    static const struct {
        enum sim_enrolled enrolled;
        size_t templates, searches;
    } cases[] = {
        {SIM_ENROLLED_ROLE, 2, 4}, {SIM_ENROLLED_FRONTAL, 2, 3}, {SIM_ENROLLED_POSES, 3, 3}};
    struct sim_eval_options options = options_for(*state);
    stored_corpus_make(*state, poses);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        options.enrolled = cases[i].enrolled;
        struct sim_eval *eval = evaluate(&options);
        assert_int_equal(eval->gallery->n_people, 2);
        assert_int_equal(eval->gallery->n_templates, cases[i].templates);
        assert_int_equal(eval->analysis->n_kind[SIM_PROBE_MATED], cases[i].searches);
        assert_int_equal(eval->analysis->n_kind[SIM_PROBE_STRANGER], 1);
        sim_eval_free(eval);
    }
}

/* Returns how many lines of a text contain a word. */
static int lines_with(const char *text, const char *word)
{
    int n = 0;
    while (*text) {
        const char *end = text + strcspn(text, "\n"), *found = strstr(text, word);
        n += found && found < end;
        text = *end ? end + 1 : end;
    }
    return n;
}

static void test_reports(void **state)
{
    struct sim_eval_options options = options_for(*state);
    struct sim_eval *eval = evaluate(&options);
    struct iso_fault fault = {.text = ""};
    assert_int_equal(sim_report_csv(eval, *state, &fault), 0);
    assert_int_equal(sim_report_json(eval, *state, &fault), 0);
    assert_int_equal(sim_report_plots(eval, *state, &fault), 0);

    char *scores = scratch_read_text(scratch_path(*state, "scores.csv"));
    assert_memory_equal(scores, "probe_recording,probe_frame,probe_subject,gallery_subject,", 58);
    assert_int_equal(lines_with(scores, ",ok"), 3 * 2);
    assert_int_equal(lines_with(scores, "p02-v1,1,p02,p01,"), 1);
    assert_int_equal(lines_with(scores, "none-nobody1,0,none,,,,fta:"), 1);
    free(scores);

    char *landmarks = scratch_read_text(scratch_path(*state, "landmarks.csv"));
    assert_int_equal(lines_with(landmarks, ",nose_tip,"), 8);
    free(landmarks);
    char *cmc = scratch_read_text(scratch_path(*state, "cmc.csv"));
    assert_int_equal(lines_with(cmc, "1,2,2,1.000000,"), 1);
    free(cmc);

    json_t *summary = json_load_file(scratch_path(*state, "summary.json"), 0, NULL);
    assert_non_null(summary);
    const char *score = NULL;
    json_int_t searches = 0, none = 0;
    double rank_1 = 0.0;
    assert_int_equal(json_unpack(summary, "{s:{s:s}, s:{s:I, s:{s:F}}, s:{s:I}}", "settings",
                                 "score", &score, "identification", "searches", &searches, "rank_1",
                                 "rate", &rank_1, "not_faces", "samples", &none),
                     0);
    assert_string_equal(score, "negative distance, mm");
    assert_int_equal(searches, 2);
    assert_int_equal(none, 1);
    assert_float_equal(rank_1, 1.0, 0.0);
    json_decref(summary);

    assert_true(scratch_exists(scratch_path(*state, "cmc.png")));
    assert_true(scratch_exists(scratch_path(*state, "det.png")));
    assert_true(scratch_exists(scratch_path(*state, "scores.png")));
    assert_int_equal(sim_report_csv(eval, scratch_path(*state, "nowhere"), &fault), -ENOENT);
    assert_non_null(strstr(fault.text, "nowhere/scores.csv: "));
    assert_int_equal(sim_report_json(eval, scratch_path(*state, "nowhere"), &fault), -EIO);
    sim_eval_free(eval);
}

/* The result does not depend on the names that the probes have. */
static void test_subjects_do_not_reach_the_scores(void **state)
{
    struct sim_eval_options options = options_for(*state);
    struct sim_eval *honest = evaluate(&options);
    char *lie = strdup(manifest);
    memcpy(strstr(lie, "p01-v1,0,2,p01"), "p01-v1,0,2,p02", 14);
    scratch_write_text(scratch_path(*state, "manifest.csv"), lie);
    free(lie);
    struct sim_eval *lied = evaluate(&options);
    assert_memory_equal(honest->matches->score, lied->matches->score, 4 * 2 * sizeof(double));
    assert_int_equal(sim_rank_rate(lied->analysis->identification.searches, 2, 1).events, 1);
    sim_eval_free(honest);
    sim_eval_free(lied);
}

static void test_damaged_frame_is_counted(void **state)
{
    assert_int_equal(unlink(scratch_path(*state, "p02-v1")), 0);
    scratch_mkdir(scratch_path(*state, "p02-v1"));
    scratch_mkdir(scratch_path(*state, "p02-v1/depth"));
    static const char *const names[] = {"recording.ini", "depth.txt"};
    for (int i = 0; i < 2; i++) {
        char *text = scratch_read_text(scratch_path(STORED "/p02-v1", names[i]));
        char name[64];
        (void)snprintf(name, sizeof name, "p02-v1/%s", names[i]);
        scratch_write_text(scratch_path(*state, name), text);
        free(text);
    }
    scratch_write_text(scratch_path(*state, "p02-v1/depth/000001.png"), "not a picture");
    struct sim_eval_options options = options_for(*state);
    struct sim_eval *eval = evaluate(&options);
    assert_int_equal(eval->analysis->probe_reason[SIM_PROBE_MATED][SIM_REASON_UNREADABLE], 1);
    assert_int_equal(eval->analysis->verification.n_lost, 1);
    sim_eval_free(eval);
}

static void expect_refusal(const struct sim_eval_options *options, int error, const char *words)
{
    struct sim_eval *eval = NULL;
    struct iso_fault fault = {.text = ""};
    assert_int_equal(sim_eval_run(options, &eval, &fault), error);
    assert_null(eval);
    if (!strstr(fault.text, words)) {
        fail_msg("'%s' does not say '%s'", fault.text, words);
    }
}

static void test_refusals(void **state)
{
    struct sim_eval_options options = options_for(*state);
    options.threads = 0;
    expect_refusal(&options, -EINVAL, "threads");
    options = options_for(*state);
    options.extract.heat = ISO_HEAT_SPECTRAL;
    expect_refusal(&options, -EINVAL, "spectral");
    options = options_for(*state);
    options.model = "/nowhere/head.model";
    expect_refusal(&options, -ENOENT, "/nowhere/head.model: ");
    options = options_for(*state);
    options.model = COHORT;
    expect_refusal(&options, -EBADMSG, "cohort.templates: ");
    options = options_for(*state);
    options.corpus = "/nowhere";
    expect_refusal(&options, -ENOENT, "/nowhere");
    options = options_for(*state);
    options.extract.n_points = 1000;
    expect_refusal(&options, -EINVAL, "out of range");
    options = options_for(*state);
    options.match.trim = 0.1;
    expect_refusal(&options, -EINVAL, "out of range");
    options = options_for(*state);
    options.cohort = COHORT;
    options.extract.t_mm2 = 123.0;
    expect_refusal(&options, -EBADMSG, "made by algorithm");
}

static void write_manifest(const char *directory, const char *origin)
{
    char text[1024];
    (void)snprintf(text, sizeof text,
                   STORED_CORPUS_HEADER "p01-enrol,0,1,p01,e,gallery,,,test-2\n"
                                        "p01-v1,0,1,p01,v1,probe,,,test-2\n"
                                        "x01-v1,0,1,x01,v1,impostor,,,%s\n",
                   origin);
    scratch_write_text(scratch_path(directory, "manifest.csv"), text);
}

/* A person from whom the shipped metric was learned cannot be tested with it, not even as a
 * stranger. The refusal names the corpus and its origin. */
static void test_nobody_the_metric_learned_from_is_tested(void **state)
{
    struct iso_fault fault = {.text = ""};
    struct iso_metric *metric = NULL;
    struct sim_eval_options options = options_for(*state);
    options.metric = METRIC;
    assert_int_equal(iso_metric_load(METRIC, &metric, &fault), 0);
    assert_true(metric->n_origins >= 2);
    for (int i = 0; i < metric->n_origins; i++) {
        char words[128];
        write_manifest(*state, metric->origin[i]);
        (void)snprintf(words, sizeof words, "learned from the people of %s (%s)",
                       (const char *)*state, metric->origin[i]);
        expect_refusal(&options, -EBADMSG, words);
        char pair[96]; /* a note as in the preset `pairs` */
        (void)snprintf(pair, sizeof pair, "%s enrolled-behind", metric->origin[i]);
        write_manifest(*state, pair);
        expect_refusal(&options, -EBADMSG, words);
    }
    iso_metric_free(metric);
    write_manifest(*state, "test-2");
    sim_eval_free(evaluate(&options));
}

/* A cohort does not list its people, so that no person of its population is tested with it. */
static void test_nobody_of_the_cohorts_population_is_tested(void **state)
{
    struct sim_eval_options options = options_for(*state);
    options.cohort = COHORT;
    write_manifest(*state, "train-7");
    expect_refusal(&options, -EBADMSG, "cohort.templates: may hold people of ");
    expect_refusal(&options, -EBADMSG, "(train-7)");
    write_manifest(*state, "test-2");
    sim_eval_free(evaluate(&options));
}

static const struct sim_sample *sample_of_row(const struct sim_eval *eval, size_t row)
{
    const struct sim_acquisition *a = eval->acquisition;
    for (size_t i = 0; i < a->n_samples; i++) {
        if (a->samples[i].row == row) {
            return &a->samples[i];
        }
    }
    fail_msg("row %zu has no sample", row);
    return NULL;
}

/* Rows are shortened by their purpose. The remaining frames are fused. */
static void test_frames_of_a_row(void **state)
{
    struct sim_eval_options options = options_for(*state);
    options.gallery_frames = 1;
    struct sim_eval *eval = evaluate(&options);
    assert_int_equal(eval->acquisition->n_captures, 1 + 1 + 2 + 1 + 1 + 1);
    assert_int_equal(sample_of_row(eval, 0)->tmpl.n_frames, 1);
    assert_int_equal(sample_of_row(eval, 2)->tmpl.n_frames, 2);
    sim_eval_free(eval);
    options.gallery_frames = 0;
    options.probe_frames = 1;
    eval = evaluate(&options);
    assert_int_equal(eval->acquisition->n_captures, 2 + 2 + 1 + 1 + 1 + 1);
    assert_int_equal(sample_of_row(eval, 0)->tmpl.n_frames, 2);
    assert_int_equal(sample_of_row(eval, 2)->tmpl.n_frames, 1);
    sim_eval_free(eval);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_figures, setup, scratch_teardown),
        cmocka_unit_test_setup_teardown(test_fuse_and_gallery_limit, setup, scratch_teardown),
        cmocka_unit_test_setup_teardown(test_poses_of_an_enrolment, scratch_setup,
                                        scratch_teardown),
        cmocka_unit_test_setup_teardown(test_reports, setup, scratch_teardown),
        cmocka_unit_test_setup_teardown(test_subjects_do_not_reach_the_scores, setup,
                                        scratch_teardown),
        cmocka_unit_test_setup_teardown(test_damaged_frame_is_counted, setup, scratch_teardown),
        cmocka_unit_test_setup_teardown(test_refusals, setup, scratch_teardown),
        cmocka_unit_test_setup_teardown(test_nobody_the_metric_learned_from_is_tested, setup,
                                        scratch_teardown),
        cmocka_unit_test_setup_teardown(test_nobody_of_the_cohorts_population_is_tested, setup,
                                        scratch_teardown),
        cmocka_unit_test_setup_teardown(test_frames_of_a_row, setup, scratch_teardown),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
