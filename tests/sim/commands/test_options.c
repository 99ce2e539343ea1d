/* Long options from tables. */
#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "sim/lab/match/extract_options.h"

struct target {
    const char *text;
    size_t count;
    double angle_rad;
    bool flag;
    struct iso_extract_options extract;
    struct iso_match_options match;
};

static struct target target;
static struct iso_fault fault;

static const struct sim_option options[] = {
    {"text", "WORD", "a text", sim_option_text, offsetof(struct target, text)},
    {"count", "N", "a count", sim_option_count, offsetof(struct target, count)},
    {"angle", "DEGREES", "an angle", sim_option_degrees, offsetof(struct target, angle_rad)},
    {"flag", NULL, "a flag", sim_option_flag, offsetof(struct target, flag)},
};

static int setup(void **state)
{
    (void)state;
    target = (struct target){
        .count = 5, .extract = iso_extract_options_default(), .match = iso_match_options_default()};
    fault.text[0] = '\0';
    return 0;
}

static enum sim_options_outcome parse(int argc, char **argv)
{
    const struct sim_option_set sets[] = {{options, 4, &target},
                                          sim_extract_option_set(&target.extract),
                                          sim_match_option_set(&target.match)};
    return sim_options_parse(argc, argv, sets, 3, &fault);
}

static void test_both_forms(void **state)
{
    (void)state;
    char *argv[] = {"eval", "--text=a=b", "--flag", "--count", "12", "--angle", "-90"};
    assert_false(target.flag);
    assert_int_equal(parse(7, argv), SIM_OPTIONS_READ);
    assert_true(target.flag);
    assert_string_equal(target.text, "a=b");
    assert_int_equal(target.count, 12);
    assert_float_equal(target.angle_rad, -M_PI_2, 1e-12);
}

static void test_extract_and_match_options(void **state)
{
    (void)state;
    char *argv[] = {"eval", "--radii",  "10,18,26", "--heat",      "spectral", "--trim",
                    "0.9",  "--points", "16",       "--transform", "affine",   "--yaw-max=30"};
    assert_int_equal(parse(12, argv), SIM_OPTIONS_READ);
    assert_int_equal(target.extract.n_radii, 3);
    assert_float_equal(target.extract.radius_mm[2], 26.0, 0.0);
    assert_int_equal(target.extract.heat, ISO_HEAT_SPECTRAL);
    assert_int_equal(target.extract.n_points, 16);
    assert_float_equal(target.extract.yaw_max_rad, M_PI / 6.0, 1e-12);
    assert_float_equal(target.match.trim, 0.9, 0.0);
    assert_int_equal(target.match.transform, ISO_ICP_AFFINE);
}

static void expect_counting(const char *value, const char *counting)
{
    char option[] = "--landmarks", words[128];
    (void)snprintf(words, sizeof words, "%s", value);
    char *argv[] = {"eval", option, words};
    memset(target.match.left_out, 0x01, sizeof target.match.left_out);
    assert_int_equal(parse(3, argv), SIM_OPTIONS_READ);
    for (int l = 0; l < ISO_LANDMARKS; l++) {
        assert_int_equal(target.match.left_out[l], counting[l] == '-');
    }
}

static void test_landmarks(void **state)
{
    (void)state;
    expect_counting("all", "nnnnnnnnnnnn");
    expect_counting("upper", "nn-nnnnnn---");
    expect_counting("mouth_l,nasion", "n----------n");
}

static void test_help_wins(void **state)
{
    (void)state;
    char *argv[] = {"eval", "--count", "1", "--help", "--nonsense"};
    assert_int_equal(parse(5, argv), SIM_OPTIONS_HELP);
}

static void test_refusals_name_the_option(void **state)
{
    (void)state;
    static const struct {
        char *words[2];
        int n;
        const char *fault;
    } bad[] = {
        {{"--nonsense"}, 1, "--nonsense: unknown option"},
        {{"--coun", "3"}, 2, "--coun: unknown option; did you mean --count?"},
        {{"--tetx=a"}, 1, "--tetx=a: unknown option; did you mean --text?"},
        {{"--hel"}, 1, "--hel: unknown option; did you mean --help?"},
        {{"--flag=yes"}, 1, "--flag=yes: takes no value"},
        {{"word"}, 1, "word: not an option"},
        {{"--count"}, 1, "--count: a value must follow"},
        {{"--count", "-3"}, 2, "--count: '-3' is no N"},
        {{"--angle", "nan"}, 2, "--angle: 'nan' is no DEGREES"},
        {{"--radii", "1,2,3,4,5"}, 2, "--radii: '1,2,3,4,5' is no MM,MM,..."},
        {{"--radii", "18,"}, 2, "--radii: '18,' is no MM,MM,..."},
        {{"--heat", "warm"}, 2, "--heat: 'warm' is no grid|direct|spectral"},
        {{"--landmarks", "chin"}, 2, "--landmarks: 'chin' is no NAME,...|all|upper"},
        {{"--landmarks", "nasion,"}, 2, "--landmarks: 'nasion,' is no NAME,...|all|upper"},
        {{"--landmarks", "nasion,nasion"},
         2,
         "--landmarks: 'nasion,nasion' is no NAME,...|all|upper"},
        {{"--landmarks", "upper,nasion"},
         2,
         "--landmarks: 'upper,nasion' is no NAME,...|all|upper"},
        {{"--transform", ""}, 2, "--transform: '' is no rigid|affine"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        char *argv[] = {"eval", bad[i].words[0], bad[i].words[1]};
        assert_int_equal(parse(1 + bad[i].n, argv), SIM_OPTIONS_REFUSED);
        assert_string_equal(fault.text, bad[i].fault);
    }
    assert_int_equal(target.count, 5);
    assert_false(target.match.left_out[ISO_LM_MOUTH_R]);
    assert_int_equal(target.extract.n_radii, iso_extract_options_default().n_radii);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup(test_both_forms, setup),
        cmocka_unit_test_setup(test_extract_and_match_options, setup),
        cmocka_unit_test_setup(test_landmarks, setup),
        cmocka_unit_test_setup(test_help_wins, setup),
        cmocka_unit_test_setup(test_refusals_name_the_option, setup),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
