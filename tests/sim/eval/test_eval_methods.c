/* Several methods on a few stored recordings, and the data from which they may learn. */
#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "sim/lab/eval/method_options.h"
#include "sim/lab/match/landmark_choice.h"
#include "sim/lab/report/report.h"
#include "sim/lab/report/report_methods.h"
#include "tests/support/scratch.h"
#include "tests/support/stored_corpus.h"

#define MODEL ISOTHERM_SOURCE_DIR "/core/data/head.model"

static const char tested[] = STORED_CORPUS_HEADER "p01-enrol,0,1,p01,s0,gallery,,,test-2\n"
                                                  "p02-enrol,1,1,p02,s0,gallery,,,test-2\n"
                                                  "p01-v1,0,1,p01,s3,probe,,mild,test-2\n"
                                                  "p02-v1,1,1,p02,s5,probe,,mild,test-2\n"
                                                  "x01-v1,0,1,x01,s1,impostor,,,test-2\n";

static const char learned[] = STORED_CORPUS_HEADER "p03-enrol,0,1,p03,s0,probe,,,train-7\n"
                                                   "p03-v1,0,1,p03,s1,probe,,,train-7\n"
                                                   "p04-enrol,0,1,p04,s0,probe,,,train-7\n"
                                                   "p04-v1,0,1,p04,s1,probe,,,train-7\n";

static void make_corpus(const char *directory, const char *manifest)
{
    scratch_mkdir(directory);
    stored_corpus_make(directory, manifest);
}

/* Two corpora of stored recordings. */
static int setup(void **state)
{
    int error = scratch_setup(state);
    if (!error) {
        make_corpus(scratch_path(*state, "tested"), tested);
        make_corpus(scratch_path(*state, "learned"), learned);
    }
    return error;
}

static struct sim_eval_options options_for(const char *directory)
{
    return (struct sim_eval_options){
        .corpus = scratch_path(directory, "tested"),
        .model = MODEL,
        .threads = 2,
        .extract = iso_extract_options_default(),
        .match = iso_match_options_default(),
    };
}

static struct sim_training_set *choose(const char *methods, const char *train,
                                       struct sim_eval_options *options)
{
    struct sim_method_choice choice;
    struct sim_training_set *training = NULL;
    struct iso_fault fault = {.text = ""};
    assert_int_equal(sim_option_methods(methods, &choice), 0);
    if (sim_method_choice_apply(&choice, train, options, &training, &fault)) {
        fail_msg("%s", fault.text);
    }
    return training;
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

static void expect_refusal(const struct sim_eval_options *options, const char *words)
{
    struct sim_eval *eval = NULL;
    struct iso_fault fault = {.text = ""};
    assert_int_equal(sim_eval_run(options, &eval, &fault), -EINVAL);
    assert_null(eval);
    if (!strstr(fault.text, words)) {
        fail_msg("'%s' does not say '%s'", fault.text, words);
    }
}

static const struct sim_matches *matches_of(const struct sim_eval *eval,
                                            const struct sim_method *method)
{
    for (size_t i = 0; i < eval->n_methods; i++) {
        if (eval->methods[i].method == method) {
            return eval->methods[i].matches;
        }
    }
    return NULL;
}

static size_t count_fields(const char *line)
{
    size_t n = 1;
    for (const char *c = line; *c; c++) {
        n += *c == ',';
    }
    return n;
}

/* methods.csv has a line for each method, with as many fields as the header. */
static void check_methods_csv(const char *directory)
{
    size_t size;
    char *csv = scratch_read(scratch_path(directory, "methods.csv"), &size);
    assert_non_null(memmem(csv, size, "tested,icp-upper,2,1,4,2,2,1.000000", 35));
    csv[size - 1] = '\0'; /* removes the end of the last line */
    char *rows = strchr(csv, '\n') + 1;
    assert_non_null(strstr(rows, "\ntested,hfpc-upper,"));
    *strchr(rows, '\n') = '\0';
    rows[-1] = '\0';
    assert_int_equal(count_fields(rows), count_fields(csv));
    assert_non_null(strstr(csv, ",seconds,fnmr_1e-2,"));
    free(csv);
}

/* Runs every method except the one that needs infrared, which the stored corpus lacks. Each method
 * has its own results: those of hfpc are the same as when it runs alone. */
static void test_all_methods(void **state)
{
    struct sim_eval_options options = options_for(*state);
    struct sim_eval *alone = evaluate(&options);
    struct sim_training_set *training = choose("all", scratch_path(*state, "learned"), &options);
    struct sim_eval *eval = evaluate(&options);
    struct sim_contest contest;
    assert_int_equal(sim_training_set_faces(training), 4);
    assert_int_equal(sim_training_set_people(training), 2);
    assert_true(eval->trained_apart);
    assert_int_equal(eval->n_methods, SIM_METHODS);
    assert_ptr_equal(eval->matches, eval->methods[0].matches);
    assert_memory_equal(alone->matches->score, eval->matches->score, 3 * 2 * sizeof(double));
    options.n_methods = 0;
    memcpy(options.match.left_out, sim_landmarks_below, sizeof sim_landmarks_below);
    struct sim_eval *upper = evaluate(&options);
    const struct sim_matches *of_upper = matches_of(eval, &sim_method_hfpc_upper);
    assert_memory_equal(upper->matches->score, of_upper->score, 3 * 2 * sizeof(double));
    assert_true(of_upper->score[0] != eval->matches->score[0]);
    sim_eval_free(upper);
    assert_int_equal(sim_contest_of(eval, &contest), 0);
    assert_string_equal(contest.corpus, "tested");
    assert_int_equal(contest.n_verdicts, SIM_METHODS - 1);
    for (size_t i = 0; i < contest.n_verdicts; i++) {
        const struct sim_verdict *v = &contest.verdicts[i];
        const struct sim_matches *m = matches_of(eval, v->method);
        assert_int_equal(v->rank_1.trials, 2);
        for (int k = 0; k < 3 * 2; k++) { /* every comparison was made */
            assert_true(isfinite(m->score[k]) && isfinite(m->distance_mm[k]));
        }
        bool learns = v->method->train != NULL; /* from only two people */
        bool coarse = v->method == &sim_method_cp_hk;
        assert_true(learns || coarse || v->rank_1.events == 2);
    }
    assert_int_equal(sim_contest_csv(&contest, 1, *state, NULL), 0);
    check_methods_csv(*state);
    struct iso_fault fault = {.text = ""};
    assert_int_equal(sim_report_plots(eval, *state, &fault), 0);
    assert_true(scratch_exists(scratch_path(*state, "det.png")));
    sim_eval_free(eval);
    sim_eval_free(alone);
    sim_training_set_free(training);
}

/* Without training data, `all` leaves out the methods that have to learn. A method that is named is
 * refused. */
static void test_nothing_to_learn_from(void **state)
{
    struct sim_eval_options options = options_for(*state);
    assert_null(choose("all", NULL, &options));
    options.methods[1] = &sim_method_icp_upper; /* instead of methods that take longer */
    options.methods[2] = &sim_method_eigensurfaces;
    options.n_methods = 3;
    struct sim_eval *eval = evaluate(&options);
    struct sim_contest contest;
    assert_int_equal(sim_contest_of(eval, &contest), 0);
    assert_int_equal(contest.n_verdicts, 2);
    assert_null(eval->methods[2].analysis);
    assert_non_null(strstr(eval->methods[2].fault.text, "eigensurfaces: has to learn"));
    sim_eval_free(eval);
    options.lenient = false;
    expect_refusal(&options, "eigensurfaces: has to learn");
}

/* The frames have no infrared image. The evaluation refuses a method that needs one; its message
 * names the corpus whose frames lack the image. */
static void test_infrared_is_needed(void **state)
{
    struct sim_eval_options options = options_for(*state);
    assert_null(choose("hfpc-weighted", NULL, &options));
    expect_refusal(&options, "hfpc-weighted: ");
    expect_refusal(&options, "tested has frames without an infrared image");
}

static void test_nobody_is_learned_from_and_tested(void **state)
{
    struct sim_eval_options options = options_for(*state);
    struct sim_training_set *training = choose("eigensurfaces", scratch_path(*state, "tested"),
                                               &options);
    expect_refusal(&options, "both the training and the test corpus");
    sim_training_set_free(training);
    /* This corpus is in another directory, but its notes name a person who is also tested. */
    make_corpus(scratch_path(*state, "mixed"),
                STORED_CORPUS_HEADER "p03-enrol,0,1,p03,s0,probe,,,train-7\n"
                                     "p04-enrol,0,1,p04,s0,probe,,,test-2\n");
    training = choose("eigensurfaces", scratch_path(*state, "mixed"), &options);
    expect_refusal(&options, "p04-enrol (test-2)");
    sim_training_set_free(training);
    /* The manifest does not say of which population one person is. The evaluation accepts the
     * corpus, but its result says that training and test people may be the same. */
    make_corpus(scratch_path(*state, "silent"),
                STORED_CORPUS_HEADER "p03-enrol,0,1,p03,s0,probe,,,\n"
                                     "p03-v1,0,1,p03,s1,probe,,,train-7\n");
    training = choose("eigensurfaces", scratch_path(*state, "silent"), &options);
    struct sim_eval *eval = evaluate(&options);
    assert_false(eval->trained_apart);
    sim_eval_free(eval);
    sim_training_set_free(training);
}

static void test_curves_and_growth(void **state)
{
    struct sim_eval_options options = options_for(*state);
    struct sim_eval *eval = evaluate(&options);
    const struct sim_curve *age = &eval->curves[SIM_FACTOR_AGE];
    assert_int_equal(age->n_bins, 2);
    assert_float_equal(age->bins[0].mean, 3.0, 0.0);
    assert_float_equal(age->bins[1].high, 5.0, 0.0);
    assert_int_equal(age->bins[1].non_match.trials, 1);
    assert_int_equal(eval->curves[SIM_FACTOR_FUSED].n_bins, 1);
    assert_int_equal(eval->curves[SIM_FACTOR_LANDMARK_ERROR].n_bins, 2);
    const struct sim_curve *distance = &eval->curves[SIM_FACTOR_DISTANCE];
    assert_true(distance->bins[0].low > 300.0 && distance->bins[1].high < 1500.0);
    assert_true(distance->bins[0].high < distance->bins[1].low);
    assert_int_equal(eval->growth.n, 1);
    assert_int_equal(eval->growth.points[0].n_people, 2);
    assert_int_equal(sim_report_csv(eval, *state, NULL), 0);
    size_t size;
    char *csv = scratch_read(scratch_path(*state, "curves.csv"), &size);
    assert_non_null(memmem(csv, size, "\nage,3.000000,3.000000,3.000000,1,0,", 36));
    free(csv);
    sim_eval_free(eval);
}

static void test_choice(void **state)
{
    (void)state;
    struct sim_method_choice choice = {0};
    assert_int_equal(sim_option_methods("icp,hfpc", &choice), 0);
    assert_int_equal(choice.n, 2);
    assert_false(choice.all);
    assert_ptr_equal(choice.methods[0], &sim_method_icp);
    assert_int_equal(sim_option_methods("icp,icp", &choice), -EINVAL);
    assert_int_equal(sim_option_methods("", &choice), -EINVAL);
    assert_int_equal(sim_option_methods("icp,", &choice), -EINVAL);
    assert_int_equal(sim_option_methods("all,icp", &choice), -EINVAL);
    assert_int_equal(choice.n, 2); /* unchanged */
    assert_int_equal(sim_option_methods("all", &choice), 0);
    assert_true(choice.all);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_all_methods, setup, scratch_teardown),
        cmocka_unit_test_setup_teardown(test_nothing_to_learn_from, setup, scratch_teardown),
        cmocka_unit_test_setup_teardown(test_infrared_is_needed, setup, scratch_teardown),
        cmocka_unit_test_setup_teardown(test_nobody_is_learned_from_and_tested, setup,
                                        scratch_teardown),
        cmocka_unit_test_setup_teardown(test_curves_and_growth, setup, scratch_teardown),
        cmocka_unit_test(test_choice),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
