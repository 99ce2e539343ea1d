/* The landmark benchmark on a few stored recordings and, if they are present, on real ones. */
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

#include "sim/lab/landmarks/study.h"
#include "tests/support/near.h"
#include "tests/support/scratch.h"
#include "tests/support/shared_data.h"
#include "tests/support/stored_corpus.h"

#define MODEL ISOTHERM_SOURCE_DIR "/core/data/head.model"

static const char manifest[] = STORED_CORPUS_HEADER "p01-enrol,0,2,p01,e,gallery,,neutral,\n"
                                                    "p01-v1,1,2,p01,v1,probe,,mild,\n"
                                                    "x06-v2,0,1,x06,v2,impostor,,mild,\n"
                                                    "none-cut4,0,1,none,c,impostor,,,cut\n"
                                                    "none-nobody1,0,2,none,n,impostor,,,nobody\n"
                                                    "none-photo3,0,2,none,p,impostor,,,photo\n";

static int setup(void **state)
{
    int error = scratch_setup(state);
    if (!error) {
        stored_corpus_make(*state, manifest);
    }
    return error;
}

static struct sim_study *study_of(const char *directory)
{
    const struct sim_study_options options = {
        .corpus = directory,
        .model = MODEL,
        .threads = 2,
        .extract = iso_extract_options_default(),
    };
    struct sim_study *study = NULL;
    struct iso_fault fault = {.text = ""};
    if (sim_study_run(&options, &study, &fault)) {
        fail_msg("%s", fault.text);
    }
    return study;
}

static void test_figures(void **state)
{
    struct sim_study *study = study_of(*state);
    const struct sim_landmark_analysis *a = study->analysis;
    assert_int_equal(study->measurement->n_frames, 10);
    assert_int_equal(a->n_bona_fide, 5);
    assert_int_equal(a->n_true, 5);
    assert_int_equal(a->all.refused.events, 0);
    assert_int_equal(a->after[ISO_LANDMARKS].error_mm.n, 12 * 5);
    assert_true(a->after[ISO_LANDMARKS].error_mm.mean < 4.0);
    assert_int_equal(a->after[ISO_LM_NASION].repeat_mm.n,
                     4); /* p01 has two sessions, x06 has one */
    assert_int_equal(a->after[ISO_LM_NASION].slip_mm.n, 4);
    assert_int_equal(a->all.failures[SIM_FAILURE_MEAN].before.trials, 5);
    assert_int_equal(a->n_conditions, 3); /* one band, two expressions */
    assert_int_equal(a->n_kinds, 3);
    for (size_t k = 0; k < 3; k++) {
        assert_int_equal(a->kinds[k].accepted_frames.events, 0);
    }
    assert_int_equal(a->kinds[2].response[SIM_RESPONSE_BONA_FIDE].trials, 1);
    assert_int_equal(a->bona_fide[SIM_RESPONSE_BONA_FIDE].events, 3);
    assert_int_equal(a->stage[ISO_STAGE_REGION].n, 10);
    assert_int_equal(a->stage[ISO_STAGE_HEAT].n, 5);
    sim_study_free(study);
}

static int count_words(const char *text, const char *word)
{
    int n = 0;
    for (const char *at = strstr(text, word); at; at = strstr(at + 1, word)) {
        n++;
    }
    return n;
}

static void test_files(void **state)
{
    struct sim_study *study = study_of(*state);
    struct iso_fault fault = {.text = ""};
    assert_int_equal(sim_study_csv(study, *state, &fault), 0);
    assert_int_equal(sim_study_json(study, *state, &fault), 0);

    char *frames = scratch_read_text(scratch_path(*state, "frames.csv"));
    assert_int_equal(count_words(frames, "\n"), 1 + 10);
    assert_int_equal(count_words(frames, ",ok,1,"), 5);
    assert_int_equal(count_words(frames, "\np01-v1,2,p01,v1,probe,,mild,,ok,1,"), 1);
    assert_int_equal(count_words(frames, "\nnone-nobody1,1,none,n,impostor,,,nobody,"), 1);
    size_t columns = 0;
    for (const char *c = frames; *c; c++) {
        columns += *c == ',';
        if (*c == '\n') {
            assert_int_equal(columns, 20 + ISO_STAGES);
            columns = 0;
        }
    }
    free(frames);

    char *landmarks = scratch_read_text(scratch_path(*state, "landmarks.csv"));
    assert_memory_equal(landmarks, "recording,frame,name,x_mm,y_mm,z_mm\np01-enrol,0,nasion,", 55);
    assert_int_equal(count_words(landmarks, "p01-"), 12 * 4);
    free(landmarks);

    json_t *summary = json_load_file(scratch_path(*state, "summary.json"), 0, NULL);
    assert_non_null(summary);
    json_int_t n = 0, trials = 0, presentations = 0;
    double mean = 0.0, high = 0.0;
    assert_int_equal(json_unpack(summary,
                                 "{s:{s:{s:I, s:F}}, s:{s:{s:{s:{s:I}}}}, s:{s:{s:{s:I, s:F}}}}",
                                 "landmarks", "all", "frames", &n, "mean_mm", &mean, "all",
                                 "failures", "mean", "before_gates", "trials", &trials, "attacks",
                                 "photo", "apcer", "trials", &presentations, "high", &high),
                     0);
    assert_int_equal(n, 60);
    assert_near(mean, study->analysis->after[ISO_LANDMARKS].error_mm.mean, 1e-6);
    assert_int_equal(trials, 5);
    assert_int_equal(presentations, 1);
    assert_near(high, 0.975, 1e-9); /* 0 of 1 */
    json_decref(summary);

    assert_int_equal(sim_study_csv(study, scratch_path(*state, "nowhere"), &fault), -ENOENT);
    assert_non_null(strstr(fault.text, "nowhere/landmarks.csv: "));
    assert_int_equal(sim_study_json(study, scratch_path(*state, "nowhere"), &fault), -EIO);
    sim_study_free(study);
}

static void test_text(void **state)
{
    struct sim_study *study = study_of(*state);
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    assert_non_null(out);
    sim_study_text(study, out);
    assert_int_equal(fclose(out), 0);
    static const char *const lines[] = {
        "10 frames of 6 rows; 5 frames of people, 5 of them with a fit and ground truth\n",
        "\n  nasion ",
        "\n  all, no gates      60 ",
        "more than 10 mm off",
        "\n  angle <= 25 ",
        "\n  expression mild ",
        "\n  nobody                      0.00 [ 0.00,  84.19] (0 of 2)",
        "\n  photo                       0.00 [ 0.00,  97.50] (0 of 1)",
        "\n  BPCER (taken for attacks)   0.00 [ 0.00,  70.76] (0 of 3)\n",
    };
    for (size_t i = 0; i < sizeof lines / sizeof *lines; i++) {
        if (!strstr(text, lines[i])) {
            fail_msg("no '%s' in:\n%s", lines[i], text);
        }
    }
    free(text);
    sim_study_free(study);
}

/* Hand marks of real faces. Marks whose names are landmarks of the product are compared; the six
 * others are not. */
static void test_real_faces(void **state)
{
    const char *real = shared_data("data/kinect2-faces/k02");
    char link[4096];
    if (access(real, R_OK) != 0) {
        print_message("no kinect2-faces: skipped\n");
        skip();
    }
    (void)snprintf(link, sizeof link, "%s", scratch_path(*state, "k02"));
    assert_int_equal(symlink(real, link), 0);
    scratch_write_text(scratch_path(*state, "manifest.csv"),
                       STORED_CORPUS_HEADER "k02,8,2,k02,0,gallery,frontal,neutral,\n"
                                            "k02,26,2,k02,1,probe,frontal,neutral,\n");
    struct sim_study *study = study_of(*state);
    const struct sim_landmark_analysis *a = study->analysis;
    assert_int_equal(a->n_true, 4);
    assert_int_equal(a->before[ISO_LM_EYE_IN_L].error_mm.n, 4);
    assert_int_equal(a->before[ISO_LM_NASION].error_mm.n, 0);
    assert_int_equal(a->before[ISO_LANDMARKS].error_mm.n, 9 * 4);
    assert_true(a->before[ISO_LANDMARKS].centred_error_mm.median < 6.0);
    sim_study_free(study);
}

static void expect_refusal(const struct sim_study_options *options, int error, const char *words)
{
    struct sim_study *study = NULL;
    struct iso_fault fault = {.text = ""};
    assert_int_equal(sim_study_run(options, &study, &fault), error);
    assert_null(study);
    if (!strstr(fault.text, words)) {
        fail_msg("'%s' does not say '%s'", fault.text, words);
    }
}

static void test_refusals(void **state)
{
    const struct sim_study_options good = {
        .corpus = *state, .model = MODEL, .threads = 1, .extract = iso_extract_options_default()};
    struct sim_study_options options = good;
    options.threads = 65;
    expect_refusal(&options, -EINVAL, "65 threads");
    options = good;
    options.threads = 2;
    options.extract.heat = ISO_HEAT_SPECTRAL;
    expect_refusal(&options, -EINVAL, "spectral");
    options = good;
    options.model = "/nowhere/head.model";
    expect_refusal(&options, -ENOENT, "/nowhere/head.model: ");
    options = good;
    options.corpus = "/nowhere";
    expect_refusal(&options, -ENOENT, "/nowhere");
    options = good;
    options.extract.n_points = 1000;
    expect_refusal(&options, -EINVAL, "out of range");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_figures, setup, scratch_teardown),
        cmocka_unit_test_setup_teardown(test_files, setup, scratch_teardown),
        cmocka_unit_test_setup_teardown(test_text, setup, scratch_teardown),
        cmocka_unit_test_setup_teardown(test_real_faces, scratch_setup, scratch_teardown),
        cmocka_unit_test_setup_teardown(test_refusals, setup, scratch_teardown),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
