/* Methods of a study of shapes: the times of heat that they look at, and parts that are missing. */
#include <errno.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "sim/shapes/make/generate.h"
#include "sim/shapes/study/study.h"
#include "tests/sim/shapes/creatures.h"
#include "tests/support/scratch.h"

/* A fifth of every query is cut away. Local heat still finds its like; the descriptors of the shape
 * as a whole do not. */
static void parts_are_found_by_local_heat(void **state)
{
    const char *corpus = scratch_path(*state, "c"), *out = scratch_path(*state, "o");
    const struct sim_shapes_options creatures = {.preset = "plain",
                                                 .out = corpus,
                                                 .seed = 3,
                                                 .classes = 6,
                                                 .shapes = 18,
                                                 .vertices = 500,
                                                 .threads = 2};
    const struct sim_shapes_study_options options = {.corpus = corpus,
                                                     .out = out,
                                                     .threads = 2,
                                                     .methods = {2, {"local-heat", "cp-hk"}},
                                                     .seed = 1,
                                                     .distortion = {SIM_DISTORTION_MISSING, 3}};
    struct iso_fault fault = {.text = ""};
    char *printed = NULL;
    int32_t n = 0;
    double local = 0.0, whole = 1.0;
    assert_int_equal(sim_shapes_generate(&creatures, &n, &fault), 0);
    assert_int_equal(run_study(&options, &printed, &fault), 0);
    free(printed);
    char *measures = scratch_read_text(scratch_path(out, "measures.csv"));
    assert_int_equal(sscanf(strstr(measures, "\nlocal-heat,"), "\nlocal-heat,nn,18,%lf", &local),
                     1);
    assert_int_equal(sscanf(strstr(measures, "\ncp-hk,"), "\ncp-hk,rcr,18,%lf", &whole), 1);
    assert_true(local > 0.8);
    assert_true(local > whole + 0.3);
    free(measures);
}

/* Features of local heat are no vectors. */
static void local_heat_is_compared_by_nn_only(void **state)
{
    const char *corpus = scratch_path(*state, "c"), *out = scratch_path(*state, "o");
    struct sim_shapes_study_options options = {.corpus = corpus,
                                               .out = out,
                                               .threads = 2,
                                               .methods = {1, {"local-heat"}},
                                               .classifiers = {1, {"crc-rls,nn-l1"}},
                                               .seed = 1};
    struct iso_fault fault = {.text = ""};
    char *printed = NULL;
    make_creatures(corpus, "plain", NULL, 3, 2);
    assert_int_equal(run_study(&options, &printed, &fault), -EINVAL);
    assert_non_null(strstr(fault.text, "the features of local-heat are no vectors"));
    free(printed);
    options.classifiers.text[0] = "crc-rls,nn";
    assert_int_equal(run_study(&options, &printed, &fault), 0);
    assert_non_null(strstr(printed, "\nlocal-heat    nn "));
    assert_null(strstr(printed, "crc-rls"));
    free(printed);
}

/* parameters.json names 50 times up to 2.5 areas and 3 words, where a method has them. */
static void expect_parameters(const char *path)
{
    char *told = scratch_read_text(path);
    const char *td = strstr(told, "\"td\""), *hk = strstr(told, "\"cp-hk\""),
               *reduced = strstr(told, "\"srcp-td\"");
    assert_non_null(td);
    assert_non_null(hk);
    assert_non_null(reduced);
    assert_memory_equal(strstr(td, "times_in_areas"), "times_in_areas\": null", 21);
    const char *number = strstr(hk, "\"number\": ");
    assert_memory_equal(number, "\"number\": 50", 12);
    assert_memory_equal(strstr(hk, "\"first\""), "\"first\": 0.0025", 15);
    assert_memory_equal(strstr(hk, "\"last\""), "\"last\": 2.5", 11);
    assert_memory_equal(strstr(hk, "\"words\""), "\"words\": null", 13);
    assert_memory_equal(strstr(reduced, "\"words\""), "\"words\": 3", 10);
    assert_non_null(strstr(told, "\"eigenpairs\": 100"));
    free(told);
}

/* A method that looks at other times of heat makes other descriptions. */
static void times_of_heat_are_chosen(void **state)
{
    const char *corpus = scratch_path(*state, "corpus"), *out = scratch_path(*state, "out");
    make_creatures(corpus, "plain", NULL, 3, 2);
    struct sim_shapes_study_options options = {.corpus = corpus,
                                               .out = out,
                                               .methods = {1, {"td,cp-hk,srcp-td"}},
                                               .classifiers = {1, {"nn-l1"}},
                                               .seed = 1,
                                               .words = 3,
                                               .times = {.n = 50, .last = 2.5},
                                               .threads = 2};
    struct iso_fault fault = {.text = ""};
    char *printed = NULL;
    if (run_study(&options, &printed, &fault)) {
        fail_msg("%s", fault.text);
    }
    free(printed);
    expect_parameters(scratch_path(out, "parameters.json"));
    char *first = scratch_read_text(scratch_path(out, "cp-hk-nn-l1/distances.csv"));
    char *same = scratch_read_text(scratch_path(out, "td-nn-l1/distances.csv"));
    options.times = (struct iso_describe_times){0, 0.0, 0.0};
    assert_int_equal(run_study(&options, &printed, &fault), 0);
    assert_non_null(strstr(printed, "0 of 27 descriptions were in the cache"));
    free(printed);
    char *own = scratch_read_text(scratch_path(out, "cp-hk-nn-l1/distances.csv"));
    char *again = scratch_read_text(scratch_path(out, "td-nn-l1/distances.csv"));
    assert_string_not_equal(first, own);
    assert_string_equal(same, again);
    free(first);
    free(own);
    free(same);
    free(again);
    options.times.n = 39;
    assert_int_equal(run_study(&options, &printed, &fault), -EINVAL);
    assert_non_null(strstr(fault.text, "cp-hk cannot have 39 times from 0.0025 to 4 areas"));
    free(printed);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(parts_are_found_by_local_heat, scratch_setup,
                                        scratch_teardown),
        cmocka_unit_test_setup_teardown(local_heat_is_compared_by_nn_only, scratch_setup,
                                        scratch_teardown),
        cmocka_unit_test_setup_teardown(times_of_heat_are_chosen, scratch_setup, scratch_teardown),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
