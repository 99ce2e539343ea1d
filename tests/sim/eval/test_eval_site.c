/* Site statistics in an evaluation: who is learned from, who is judged, and the rates. */
#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "sim/lab/eval/eval.h"
#include "sim/lab/eval/site_rates.h"
#include "sim/lab/report/report.h"
#include "tests/support/near.h"
#include "tests/support/scratch.h"
#include "tests/support/stored_corpus.h"

static const char four_people[] = STORED_CORPUS_HEADER "p01-enrol,0,2,p01,e,gallery,,,\n"
                                                       "p02-enrol,0,2,p02,e,gallery,,,\n"
                                                       "p03-enrol,0,2,p03,e,gallery,,,\n"
                                                       "p04-enrol,0,2,p04,e,gallery,,,\n"
                                                       "p01-v1,0,2,p01,v1,probe,,mild,\n"
                                                       "p02-v1,0,1,p02,v1,probe,,mild,\n"
                                                       "p03-v1,0,1,p03,v1,probe,,mild,\n"
                                                       "x01-v1,0,1,x01,v1,impostor,,,\n";
/* The same visits, but p01 is a stranger to the site. */
static const char without_the_first[] = STORED_CORPUS_HEADER "p02-enrol,0,2,p02,e,gallery,,,\n"
                                                             "p03-enrol,0,2,p03,e,gallery,,,\n"
                                                             "p04-enrol,0,2,p04,e,gallery,,,\n"
                                                             "p01-v1,0,2,p01,v1,impostor,,mild,\n"
                                                             "p02-v1,0,1,p02,v1,probe,,mild,\n"
                                                             "p03-v1,0,1,p03,v1,probe,,mild,\n"
                                                             "x01-v1,0,1,x01,v1,impostor,,,\n";
static const char three_people[] = STORED_CORPUS_HEADER "p01-enrol,0,2,p01,e,gallery,,,\n"
                                                        "p02-enrol,0,2,p02,e,gallery,,,\n"
                                                        "p03-enrol,0,2,p03,e,gallery,,,\n"
                                                        "p01-v1,0,2,p01,v1,probe,,mild,\n"
                                                        "p02-v1,0,1,p02,v1,probe,,mild,\n";

static int evaluate(void **state, const char *manifest, enum sim_site site, struct sim_eval **out,
                    struct iso_fault *fault)
{
    stored_corpus_make(*state, manifest);
    const struct sim_eval_options options = {
        .corpus = *state,
        .model = ISOTHERM_SOURCE_DIR "/core/data/head.model",
        .metric = ISOTHERM_SOURCE_DIR "/core/data/face.metric",
        .fuse = 1,
        .threads = 2,
        .extract = iso_extract_options_default(),
        .match = iso_match_options_default(),
        .site = site,
    };
    return sim_eval_run(&options, out, fault);
}

static struct sim_eval *evaluated(void **state, enum sim_site site)
{
    struct sim_eval *eval = NULL;
    struct iso_fault fault = {.text = ""};
    if (evaluate(state, four_people, site, &eval, &fault)) {
        fail_msg("%s", fault.text);
    }
    return eval;
}

/* Four people have six choices of two, and each counts both ways. A person is judged in the six of
 * the twelve in which this person is not learned from, beside one other person. */
static void every_split_counts_both_ways(void **state)
{
    struct sim_eval *eval = evaluated(state, SIM_SITE_SPLIT);
    const struct sim_site_split *site = &eval->site;
    assert_int_equal(site->people, 4);
    assert_int_equal(site->learned, 2);
    assert_int_equal(site->splits, 12);
    assert_int_equal(site->refused.trials, 4); /* searches of p01 to p03, but not of x01 */
    const size_t acquired = site->refused.trials - site->refused.events;
    assert_int_equal(site->rank_1.trials, 6 * acquired);
    assert_int_equal(site->rank_1.events, site->rank_1.trials); /* stored people are told apart */
    assert_true(site->offset > 0.0 && site->growth > 0.0);
    assert_true(site->share > 0.0 && site->share < 0.5);
    assert_near(site->eer, 0.0, 1e-12);
    assert_true(site->calibration.known);
    assert_near(site->calibration.cllr_min, 0.0, 1e-12);
    assert_true(eval->calibration.known && eval->calibration.cllr < 0.1);
    for (int i = 0; i < SIM_SITE_SCORES; i++) {
        const struct sim_site_rate *at = &site->at[i];
        assert_near(at->score, 2.0 + i, 0.0);
        assert_true(at->fmr_interval.low <= at->fmr && at->fmr <= at->fmr_interval.high);
        assert_true(at->fnmr_interval.low <= at->fnmr && at->fnmr <= at->fnmr_interval.high);
    }
    sim_eval_free(eval);
}

static void fewer_than_four_people_are_not_split(void **state)
{
    struct sim_eval *eval = NULL;
    struct iso_fault fault = {.text = ""};
    assert_int_equal(evaluate(state, three_people, SIM_SITE_SPLIT, &eval, &fault), -EINVAL);
    assert_non_null(strstr(fault.text, "--site split: needs four enrolled people"));
    assert_null(eval);
}

/* Compares the searches of p01, place 0 in the gallery of `site`, with those of the stranger in
 * `without`. Returns the number of comparisons. */
static size_t compare_strangers(const struct sim_eval *site, const struct sim_eval *without)
{
    const struct sim_matches *a = site->matches, *b = without->matches;
    size_t compared = 0;
    for (size_t i = 0; i < a->n_probes; i++) {
        for (size_t p = 1; site->analysis->mate[i] == 0 && p < a->n_people; p++, compared++) {
            const double score = sim_matches_compared(a, i, p, 0);
            assert_true(score == b->score[i * b->n_people + p - 1]);
            assert_true(score != a->score[i * a->n_people + p]);
        }
    }
    return compared;
}

/* scores.csv has the scores by which the visitors are judged. */
static void the_scores_written_are_those_judged(void **state)
{
    struct sim_eval *eval = evaluated(state, SIM_SITE_GALLERY);
    const struct sim_matches *m = eval->matches;
    struct iso_fault fault = {.text = ""};
    char line[256];
    size_t rows = 0;
    assert_int_equal(sim_report_csv(eval, *state, &fault), 0);
    FILE *file = fopen(scratch_path(*state, "scores.csv"), "re");
    assert_non_null(file);
    assert_non_null(fgets(line, sizeof line, file)); /* names */
    for (size_t i = 0; i < m->n_probes; i++) {
        const bool acquired = eval->acquisition->samples[m->sample[i]].acquired;
        for (size_t p = 0; p < (acquired ? m->n_people : 1); p++, rows += acquired) {
            double score = NAN;
            assert_non_null(fgets(line, sizeof line, file));
            assert_int_equal(sscanf(line, "%*[^,],%*[^,],%*[^,],%*[^,],%*[^,],%lf", &score),
                             acquired);
            if (acquired) {
                assert_near(score, sim_matches_compared(m, i, p, eval->analysis->mate[i]), 1e-6);
            }
        }
    }
    assert_int_equal(fclose(file), 0);
    assert_true(rows >= 8);
    sim_eval_free(eval);
}

/* An enrolled visitor who claims to be another person gets exactly the scores that he or she would
 * get as a stranger at the same site. The own scores, and those of strangers, are the daemon's. */
static void a_visitor_is_judged_as_a_stranger(void **state)
{
    struct sim_eval *site = evaluated(state, SIM_SITE_GALLERY), *without = NULL;
    struct iso_fault fault = {.text = ""};
    void *second = NULL;
    assert_int_equal(scratch_setup(&second), 0);
    if (evaluate(&second, without_the_first, SIM_SITE_GALLERY, &without, &fault)) {
        fail_msg("%s", fault.text);
    }
    const struct sim_matches *m = site->matches;
    assert_non_null(m->stranger_score);
    assert_int_equal(m->n_probes, without->matches->n_probes);
    assert_int_equal(compare_strangers(site, without), 6); /* two samples, three other people */
    for (size_t i = 0; i < m->n_probes; i++) {
        const size_t mate = site->analysis->mate[i], own = mate == SIM_NOBODY ? 0 : mate;
        assert_true(sim_matches_compared(m, i, own, mate) == m->score[i * m->n_people + own]);
    }
    sim_eval_free(site);
    sim_eval_free(without);
    (void)scratch_teardown(&second);
}

/* Without site statistics the metric is the shipped one; with those of the gallery it differs, and
 * so do the scores, but everybody is still found. */
static void the_gallery_adapts_the_metric(void **state)
{
    struct sim_eval *none = evaluated(state, SIM_SITE_NONE);
    struct sim_eval *site = evaluated(state, SIM_SITE_GALLERY);
    assert_int_equal(none->site.splits, 0);
    assert_int_equal(site->site.splits, 0);
    assert_false(site->site.calibration.known);
    assert_null(none->matches->stranger_score);
    assert_null(none->adapted.metric);
    assert_true(site->metric->between[0] != site->adapted.metric->between[0]);
    assert_int_equal(site->adapted.people, site->gallery->n_people);
    const struct sim_matches *a = none->matches, *b = site->matches;
    assert_int_equal(a->n_probes, b->n_probes);
    for (size_t i = 0; i < b->n_probes; i++) {
        const size_t mate = site->analysis->mate[i];
        const double *score = &b->score[i * b->n_people];
        for (size_t p = 0; mate != SIM_NOBODY && p < b->n_people; p++) {
            assert_true(score[p] != a->score[i * a->n_people + p]);
            assert_true(p == mate || score[p] < score[mate]);
        }
    }
    sim_eval_free(none);
    sim_eval_free(site);
}

/* The searches are of the sensor that has enrolled everybody. As if p04 had been enrolled before
 * another sensor, the metric is that of the other three, to the bit. */
static void only_people_of_the_searching_sensor_teach(void **state)
{
    struct sim_eval *eval = evaluated(state, SIM_SITE_SENSOR);
    struct sim_gallery *gallery = eval->gallery, *three = NULL;
    struct iso_site_metric own = {.n = 0}, expected = {.n = 0};
    const bool keep[] = {true, true, true, false};
    assert_string_equal(gallery->teaching, "astra");
    assert_int_equal(eval->adapted.people, 4);
    for (size_t i = 0; i < gallery->n_templates; i++) {
        if (gallery->person[i] == 3) {
            struct iso_template *tmpl = &eval->acquisition->samples[gallery->sample[i]].tmpl;
            (void)snprintf(tmpl->sensor, sizeof tmpl->sensor, "other");
        }
    }
    assert_int_equal(sim_gallery_part(gallery, keep, &three), 0);
    assert_int_equal(sim_site_adapt(gallery, eval->metric, &own), 0);
    assert_int_equal(sim_site_adapt(three, eval->metric, &expected), 0);
    assert_int_equal(own.people, 3);
    assert_int_equal(own.n, expected.n);
    assert_memory_equal(own.offset, expected.offset, (size_t)own.n * sizeof *own.offset);
    assert_memory_equal(own.turn, expected.turn, (size_t)own.n * (size_t)own.n * sizeof *own.turn);
    gallery->teaching = NULL; /* everybody */
    iso_site_metric_free(&own);
    assert_int_equal(sim_site_adapt(gallery, eval->metric, &own), 0);
    assert_int_equal(own.people, 4);
    iso_site_metric_free(&own);
    iso_site_metric_free(&expected);
    sim_gallery_free(three);
    sim_eval_free(eval);
}

static void options_name_the_source(void **state)
{
    enum sim_site site = SIM_SITE_NONE;
    (void)state;
    assert_int_equal(sim_option_site("gallery", &site), 0);
    assert_int_equal(site, SIM_SITE_GALLERY);
    assert_int_equal(sim_option_site("split", &site), 0);
    assert_int_equal(site, SIM_SITE_SPLIT);
    assert_int_equal(sim_option_site("sensor", &site), 0);
    assert_int_equal(site, SIM_SITE_SENSOR);
    assert_int_equal(sim_option_site("none", &site), 0);
    assert_int_equal(site, SIM_SITE_NONE);
    assert_int_equal(sim_option_site("halves", &site), -EINVAL);
}

/* Two people with two mated and two non-mated comparisons each, counted by hand. */
static void rates_are_counted_at_each_score(void **state)
{
    struct sim_score mated[] = {{5.0, 0}, {3.5, 0}, {2.5, 1}, {6.0, 1}};
    struct sim_score non_mated[] = {{-1.0, 0}, {2.0, 0}, {3.1, 1}, {0.0, 1}};
    struct sim_scores scores = {mated, non_mated, 4, 4};
    struct sim_site_split out = {.refused = {3, 7}};
    (void)state;
    assert_int_equal(sim_site_rates(&scores, 2, &out), 0);
    assert_near(out.at[0].fmr, 0.5, 1e-12);  /* 2.0 and 3.1 reach 2 */
    assert_near(out.at[1].fmr, 0.25, 1e-12); /* 3.1 reaches 3 */
    assert_near(out.at[2].fmr, 0.0, 1e-12);
    assert_near(out.at[0].fnmr, 0.0, 1e-12);
    assert_near(out.at[1].fnmr, 0.25, 1e-12); /* 2.5 */
    assert_near(out.at[2].fnmr, 0.5, 1e-12);
    assert_near(out.eer, 0.25, 1e-12);
    /* Three more failures beside the four comparisons: at the score 2.5, 3 of 7 fail. */
    assert_near(out.eer_with_refused, 3.0 / 7.0, 1e-12);
    assert_true(out.at[2].fmr_interval.high > 0.2); /* none of four does not mean none at all */
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(only_people_of_the_searching_sensor_teach, scratch_setup,
                                        scratch_teardown),
        cmocka_unit_test_setup_teardown(every_split_counts_both_ways, scratch_setup,
                                        scratch_teardown),
        cmocka_unit_test_setup_teardown(fewer_than_four_people_are_not_split, scratch_setup,
                                        scratch_teardown),
        cmocka_unit_test_setup_teardown(the_gallery_adapts_the_metric, scratch_setup,
                                        scratch_teardown),
        cmocka_unit_test_setup_teardown(a_visitor_is_judged_as_a_stranger, scratch_setup,
                                        scratch_teardown),
        cmocka_unit_test_setup_teardown(the_scores_written_are_those_judged, scratch_setup,
                                        scratch_teardown),
        cmocka_unit_test(options_name_the_source),
        cmocka_unit_test(rates_are_counted_at_each_score),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
