/* From scores to figures, on an evaluation that is small enough to calculate by hand. */
#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "sim/lab/eval/analysis.h"

/* clang-format off */
/* The people are a, b and c; c could not be enrolled. Rows 0..2 enrol. The other rows are probes:
 *
 *   row  subject  pose   score against a, b, c
 *     3  a        yaw    9  1  -                rank 1
 *     4  a        yaw    not acquired           lost
 *     5  b        yaw    6  5  -                rank 2
 *     6  c        front  4  2  -                lost: not enrolled
 *     7  x               3  8  -                a stranger
 *     8  y               not acquired           a stranger
 *     9  none            9  7  -                a photograph that was taken for a face
 *    10  b        yaw    1  7  -                rank 1
 *    11  b        yaw    2  7  -                rank 1
 */
/* clang-format on */
enum { ROWS = 12, PEOPLE = 3, PROBES = 9 };

static struct sim_corpus_row rows[ROWS] = {
    {.subject = "a", .role = SIM_ROLE_GALLERY},
    {.subject = "b", .role = SIM_ROLE_GALLERY},
    {.subject = "c", .role = SIM_ROLE_GALLERY},
    {.subject = "a", .role = SIM_ROLE_PROBE, .pose = "yaw"},
    {.subject = "a", .role = SIM_ROLE_PROBE, .pose = "yaw"},
    {.subject = "b", .role = SIM_ROLE_PROBE, .pose = "yaw"},
    {.subject = "c", .role = SIM_ROLE_PROBE, .pose = "front"},
    {.subject = "x", .role = SIM_ROLE_IMPOSTOR},
    {.subject = "y", .role = SIM_ROLE_IMPOSTOR},
    {.subject = "none", .role = SIM_ROLE_IMPOSTOR, .note = "photo"},
    {.subject = "b", .role = SIM_ROLE_PROBE, .pose = "yaw"},
    {.subject = "b", .role = SIM_ROLE_PROBE, .pose = "yaw"},
};
static struct sim_corpus corpus = {ROWS, rows};

static struct sim_capture captures[ROWS];
static struct sim_sample samples[ROWS];
static struct sim_acquisition acquisition = {ROWS, ROWS, captures, samples, {0, ""}};

static const char *names[PEOPLE] = {"a", "b", "c"};
static size_t n_templates_of[PEOPLE] = {1, 1, 0};
static struct sim_gallery gallery = {
    .n_people = PEOPLE, .n_templates = 2, .names = names, .n_templates_of = n_templates_of};

#define NO -INFINITY
static double score[PROBES * PEOPLE] = {
    9, 1, NO, NO, NO, NO, 6, 5, NO, 4, 2, NO, 3, 8, NO, NO, NO, NO, 9, 7, NO, 1, 7, NO, 2, 7, NO,
};
static size_t sample_of_probe[PROBES] = {3, 4, 5, 6, 7, 8, 9, 10, 11};
static int64_t wall_ns[PROBES],
    cpu_ns[PROBES] = {1000000, 0, 3000000, 2000000, 2000000, 0, 2000000};
static struct sim_matches matches = {.n_probes = PROBES,
                                     .n_people = PEOPLE,
                                     .sample = sample_of_probe,
                                     .distance_mm = score,
                                     .score = score,
                                     .wall_ns = wall_ns,
                                     .cpu_ns = cpu_ns};

static int analyse(void **state)
{
    for (size_t i = 0; i < ROWS; i++) {
        bool acquired = i != 2 && i != 4 && i != 8;
        enum iso_capture outcome = acquired ? ISO_CAPTURE_OK : ISO_CAPTURE_TOO_FAR;
        samples[i] = (struct sim_sample){.row = i,
                                         .first_capture = i,
                                         .n_captures = 1,
                                         .acquired = acquired,
                                         .reason = (int)outcome};
        captures[i] = (struct sim_capture){
            .row = i, .readable = true, .cpu_ns = 1000000 * (int64_t)(i + 1)};
        captures[i].extraction.outcome = outcome;
        captures[i].extraction.stage_ns[ISO_STAGE_HEAT] = 1000000 * (int64_t)i;
    }
    struct sim_analysis *analysis = NULL;
    int error = sim_analyse(&corpus, &acquisition, &gallery, &matches, &analysis);
    *state = analysis;
    return error;
}

static int release(void **state)
{
    sim_analysis_free(*state);
    return 0;
}

static void test_kinds(void **state)
{
    const struct sim_analysis *a = *state;
    assert_int_equal(a->n_kind[SIM_PROBE_MATED], 6);
    assert_int_equal(a->n_kind[SIM_PROBE_STRANGER], 2);
    assert_int_equal(a->n_kind[SIM_PROBE_NONE], 1);
    assert_int_equal(a->n_people_not_enrolled, 1);
    assert_int_equal(a->n_gallery_samples, 3);
    assert_int_equal(a->gallery_reason[ISO_CAPTURE_TOO_FAR], 1);
    assert_int_equal(a->probe_reason[SIM_PROBE_MATED][ISO_CAPTURE_TOO_FAR], 1);
    assert_int_equal(a->probe_reason[SIM_PROBE_STRANGER][ISO_CAPTURE_TOO_FAR], 1);
    assert_int_equal(a->probe_reason[SIM_PROBE_MATED][ISO_CAPTURE_OK], 5);
    assert_int_equal(a->n_usable_captures, 9);
}

static void test_comparisons(void **state)
{
    const struct sim_verification *v = &((const struct sim_analysis *)*state)->verification;
    /* The mated scores are 9, 5, 7, 7. The probe that was not acquired and the one of the person
     * who is not enrolled are lost. */
    assert_int_equal(v->scores.n_mated, 4);
    assert_int_equal(v->n_lost, 2);
    /* The non-mated scores are b 1; a 6; a 4, b 2; a 3, b 8; a 1; a 2. Those of `none` do not
     * count. */
    assert_int_equal(v->scores.n_non_mated, 8);
    assert_float_equal(v->scores.non_mated[7].score, 8.0, 0.0);
    /* FMR 0.1 of 8 allows no match. So 5, 7, 7 of the mated scores fail, and of all 6 the two lost
     * ones as well. */
    assert_float_equal(v->at_fmr[0].at.fnmr, 0.75, 1e-15);
    assert_float_equal(v->at_fmr[0].at.threshold, 9.0, 0.0);
    assert_int_equal(v->at_fmr[0].gfnmr.events, 5);
    assert_int_equal(v->at_fmr[0].gfnmr.trials, 6);
    assert_false(v->at_fmr[0].supported); /* 3 / 8 > 0.1 */
    assert_true(v->at_fmr[0].fnmr.low <= 0.75 && v->at_fmr[0].fnmr.high >= 0.75);
}

static void test_searches(void **state)
{
    const struct sim_analysis *a = *state;
    const struct sim_identification *id = &a->identification;
    assert_int_equal(id->n_searches, 6);
    assert_int_equal(id->n_strangers, 2);
    assert_int_equal(sim_rank_rate(id->searches, 6, 1).events, 3);
    assert_int_equal(sim_rank_rate(id->searches, 6, 2).events, 4);
    assert_int_equal(sim_rank_rate(id->searches, 6, PEOPLE).events, 4); /* two of them are lost */
    /* FPIR 0.1 of 2 does not allow the stranger's 8, so that only the 9 is accepted. */
    assert_int_equal(id->at_fpir[0].fpir.events, 0);
    assert_int_equal(id->at_fpir[0].fnir.events, 5);
}

static void test_not_faces_are_apart(void **state)
{
    const struct sim_analysis *a = *state;
    assert_int_equal(a->probe_reason[SIM_PROBE_NONE][ISO_CAPTURE_OK], 1);
    assert_int_equal(a->none_matched, 1); /* its 9 is at the threshold */
}

static void test_conditions(void **state)
{
    const struct sim_analysis *a = *state;
    /* "front" has only one search and is not reported. */
    assert_int_equal(a->n_conditions, 1);
    const struct sim_condition *yaw = &a->conditions[0];
    assert_string_equal(yaw->column, "pose");
    assert_string_equal(yaw->value, "yaw");
    assert_int_equal(yaw->rank_1.events, 3);
    assert_int_equal(yaw->rank_1.trials, 5);
    assert_int_equal(yaw->rank_4.events, 4);
    assert_int_equal(yaw->not_acquired.events, 1);
    /* Mated 9, 5, 7, 7 against non-mated 1, 6, 1, 2: the rates are equal between (0.25, 0) and
     * (0.25, 0.25). */
    assert_float_equal(yaw->eer, 0.25, 1e-15);
}

static void test_latencies(void **state)
{
    const struct sim_analysis *a = *state;
    assert_int_equal(a->search_cpu.n, 7);
    assert_int_equal(a->extract_cpu.n, 9); /* only usable frames */
    assert_float_equal(a->extract_cpu.p95_ms, 12.0, 1e-9);
    assert_float_equal(a->stage[ISO_STAGE_HEAT].median_ms, 6.0, 1e-9);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_kinds),      cmocka_unit_test(test_comparisons),
        cmocka_unit_test(test_searches),   cmocka_unit_test(test_not_faces_are_apart),
        cmocka_unit_test(test_conditions), cmocka_unit_test(test_latencies),
    };
    return cmocka_run_group_tests(tests, analyse, release);
}
