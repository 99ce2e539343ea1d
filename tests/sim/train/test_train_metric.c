/* Learning of the metric on samples with known covariances, and the shipped metric. */
#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "core/match/rerank.h"
#include "drivers/model/model_file.h"
#include "isotherm/extract.h"
#include "sim/base/random.h"
#include "sim/corpus/corpus.h"
#include "sim/train/metric/metric_learn.h"
#include "sim/train/metric/metric_shape.h"
#include "sim/train/metric/rerank_learn.h"
#include "sim/world/face/person.h"

enum { PEOPLE = 400, EACH = 6, DIMENSIONS = 3 };

static struct iso_metric *new_metric(int dimensions)
{
    const struct iso_metric shape = {.landmarks = 1,
                                     .n_radii = 1,
                                     .n_points = 4,
                                     .n_dimensions = dimensions,
                                     .weight_min = 0.3f,
                                     .gain = 1.0f};
    struct iso_metric *m = NULL;
    assert_int_equal(iso_metric_new(&shape, &m), 0);
    return m;
}

/* The values 0, 1 and 2 differ between people by 6, 3 and 1, and within a person by 1, 3 and 0.5.
 * The other values are noise of 0.05. */
static void draw(float *residual_mm, size_t *person, size_t width)
{
    static const double across[] = {6.0, 3.0, 1.0}, within[] = {1.0, 3.0, 0.5};
    struct sim_random random = sim_random_seeded(5, 6, 7);
    for (size_t p = 0; p < PEOPLE; p++) {
        double mean[3];
        for (int k = 0; k < 3; k++) {
            mean[k] = 10.0 * k + across[k] * sim_random_normal(&random);
        }
        for (size_t e = 0; e < EACH; e++) {
            float *row = &residual_mm[(p * EACH + e) * width];
            person[p * EACH + e] = p;
            for (size_t v = 0; v < width; v++) {
                row[v] = (float)((v < 3 ? mean[v] + within[v] * sim_random_normal(&random)
                                        : 0.05 * sim_random_normal(&random)));
            }
        }
    }
}

static void it_finds_what_tells_people_apart(void **state)
{
    (void)state;
    struct iso_metric *m = new_metric(DIMENSIONS);
    const size_t width = (size_t)m->n_values;
    float *residual_mm = calloc(PEOPLE * EACH * width, sizeof *residual_mm);
    size_t *person = calloc(PEOPLE * EACH, sizeof *person);
    assert_true(residual_mm && person);
    draw(residual_mm, person, width);
    const struct sim_metric_samples samples = {PEOPLE * EACH, PEOPLE, residual_mm, person};
    double explained = 0.0;
    assert_int_equal(sim_metric_learn(&samples, m, &explained), 0);
    assert_true(explained > 0.995 && explained <= 1.0);
    /* The ratios of variances are 36, 4 and 1. With 400 people their standard error is 7 %. */
    static const double expected[] = {36.0, 4.0, 1.0};
    for (int d = 0; d < DIMENSIONS; d++) {
        assert_true(fabs((double)m->between[d] / expected[d] - 1.0) < 0.25);
    }
    /* Within a person every dimension has the variance 1. Over all people the mean is 0. */
    for (size_t d = 0; d < DIMENSIONS; d++) {
        double all = 0.0, inside = 0.0;
        for (size_t p = 0; p < PEOPLE; p++) {
            double y[EACH], mean = 0.0;
            for (size_t e = 0; e < EACH; e++) {
                y[e] = -(double)m->centre[d];
                for (size_t v = 0; v < width; v++) {
                    y[e] += (double)residual_mm[(p * EACH + e) * width + v] *
                            (double)m->axis[v * DIMENSIONS + d];
                }
                mean += y[e] / EACH;
            }
            for (size_t e = 0; e < EACH; e++) {
                inside += (y[e] - mean) * (y[e] - mean) / (PEOPLE * (EACH - 1));
            }
            all += mean / PEOPLE;
        }
        assert_true(fabs(inside - 1.0) < 0.01 && fabs(all) < 0.01);
    }
    free(residual_mm);
    free(person);
    iso_metric_free(m);
}

static void too_few_people_teach_nothing(void **state)
{
    (void)state;
    struct iso_metric *m = new_metric(DIMENSIONS);
    float residual_mm[5 * 12] = {0};
    const size_t person[5] = {0, 1, 2, 3, 4};
    const struct sim_metric_samples samples = {5, 5, residual_mm, person};
    assert_int_equal(sim_metric_learn(&samples, m, NULL), -ENODATA);
    iso_metric_free(m);
}

/* The share of ratios above a value is 0.1 at -3, and falls by a decade per 4. */
static void a_score_says_how_rare_it_is_among_strangers(void **state)
{
    (void)state;
    enum { N = 20000 };
    double *ratio = calloc(N, sizeof *ratio);
    assert_non_null(ratio);
    for (int i = 0; i < N; i++) {
        ratio[(7919 * (size_t)i) % N] = -3.0 - 4.0 * (log10((i + 1.0) / N) + 1.0);
    }
    float gain = 0.0f, bias = 0.0f;
    assert_int_equal(sim_metric_calibrate(ratio, 500, &gain, &bias), -ENODATA);
    assert_int_equal(sim_metric_calibrate(ratio, N, &gain, &bias), 0);
    assert_true(fabsf(gain - 0.25f) < 0.01f);
    assert_true(fabsf(gain * -3.0f + bias - 1.0f) < 0.05f);
    assert_true(fabsf(gain * 5.0f + bias - 3.0f) < 0.05f);
    for (int i = 0; i < N; i++) {
        ratio[i] = 1.0;
    }
    assert_int_equal(sim_metric_calibrate(ratio, N, &gain, &bias), -EDOM);
    free(ratio);
}

/* The share of scores above a value falls by a decade per 1 and that of the fits by a decade per
 * 0.2, independently. The fit counts five times as much as the score, and the fused score tells how
 * rare it is. */
static void a_fused_score_says_how_rare_it_is_among_strangers(void **state)
{
    (void)state;
    enum { N = 60000 };
    double *score = calloc(N, sizeof *score), *fit = calloc(N, sizeof *fit);
    assert_true(score && fit);
    for (size_t i = 0; i < N; i++) { /* every tenth cannot be registered */
        score[i] = -log10((double)(7919 * i % N + 1) / N);
        fit[i] = i % 10 == 0 ? NAN : -1.0 - 0.2 * log10((double)(22123 * i % N + 1) / N);
    }
    struct iso_rerank_weights weights = {0};
    struct sim_rerank_pairs pairs = {5000, score, fit};
    assert_int_equal(sim_rerank_learn(&pairs, &weights), -ENODATA);
    assert_true(weights.upper == 0.0f);
    pairs.n = N;
    assert_int_equal(sim_rerank_learn(&pairs, &weights), 0);
    assert_true(fabsf(weights.upper / weights.metric - 5.0f) < 0.3f);
    int above[2] = {0, 0}, n = 0;
    for (int i = 0; i < N; i++) {
        const bool known = !isnan(fit[i]);
        const double fused = known ? iso_rerank_fuse(&weights, score[i], exp(-fit[i])) : 0.0;
        n += known;
        above[0] += fused >= 2.0;
        above[1] += fused >= 3.0;
    }
    assert_true(fabs(log10((double)above[0] / n) + 2.0) < 0.12);
    assert_true(fabs(log10((double)above[1] / n) + 3.0) < 0.12);
    for (int i = 0; i < N; i++) {
        fit[i] = 1.0;
    }
    assert_int_equal(sim_rerank_learn(&pairs, &weights), -EDOM);
    free(score);
    free(fit);
}

/* A template whose heights are all `z_mm`, and which has a height at the node `gap` or not. */
static void make_flat(struct iso_template *tmpl, float z_mm, bool gap)
{
    memset(tmpl, 0, sizeof *tmpl);
    for (int row = 0; row < ISO_UPPER_ROWS; row++) {
        for (int column = 0; column < ISO_UPPER_COLUMNS; column++) {
            tmpl->upper.z_mm[row][column] = z_mm;
            tmpl->upper.kind[row][column] = ISO_UPPER_MEASURED;
        }
    }
    if (gap) {
        tmpl->upper.z_mm[4][4] = 0.0f;
        tmpl->upper.kind[4][4] = ISO_UPPER_NONE;
    }
}

/* The people who calibrate the scores choose no node and shift no mean: here they lack a height
 * that all others have, and their faces lie 100 mm farther out. */
static void people_held_out_teach_no_shape(void **state)
{
    (void)state;
    enum { N = 10 };
    static struct iso_template tmpl[N];
    static size_t person[N];
    for (size_t i = 0; i < N; i++) {
        person[i] = i;
        const bool held_out = sim_metric_is_held_out(i);
        make_flat(&tmpl[i], held_out ? 110.0f : 10.0f, held_out);
    }
    const struct sim_metric_templates all = {.n = N, .tmpl = tmpl, .person = person, .n_people = N};
    struct iso_metric shape = {.landmarks = 1, .n_radii = 1, .n_points = 4, .n_dimensions = 3};
    struct iso_metric *metric = NULL;
    sim_metric_choose_nodes(&all, &shape);
    assert_int_equal(shape.n_nodes, (ISO_UPPER_ROWS * ISO_UPPER_COLUMNS + 1) / 2);
    assert_int_equal(iso_metric_new(&shape, &metric), 0);
    assert_int_equal(sim_metric_learn_means(&all, metric), 0);
    for (int i = 0; i < metric->n_nodes; i++) {
        assert_true(fabsf(metric->upper_mm[i] - 10.0f) < 1e-4f);
    }
    iso_metric_free(metric);
}

/* No person from whom the shipped metric was learned may be in a test. It was learned only from
 * people of the population `train`, and a committed corpus names none of its sources. */
static void the_shipped_metric_knows_nobody_who_is_tested(void **state)
{
    (void)state;
    struct iso_fault fault = {.text = ""};
    struct iso_metric *metric = NULL;
    struct sim_corpus *stored = NULL;
    assert_int_equal(iso_metric_load(ISOTHERM_SOURCE_DIR "/core/data/face.metric", &metric, &fault),
                     0);
    assert_int_equal(sim_corpus_read(ISOTHERM_SOURCE_DIR "/sim/stored", &stored, &fault), 0);
    assert_true(metric->n_origins >= 2);
    const size_t length = strlen(SIM_POPULATION_TRAIN "-");
    for (int i = 0; i < metric->n_origins; i++) {
        assert_int_equal(strncmp(metric->origin[i], SIM_POPULATION_TRAIN "-", length), 0);
        for (size_t row = 0; row < stored->n_rows; row++) {
            assert_string_not_equal(metric->origin[i], stored->rows[row].note);
        }
    }
    sim_corpus_free(stored);
    iso_metric_free(metric);
}

static void the_shipped_metric_fits_the_shipped_head_model(void **state)
{
    (void)state;
    struct iso_fault fault = {.text = ""};
    struct iso_metric *metric = NULL;
    struct iso_head_model *model = NULL;
    struct iso_extractor *extractor = NULL;
    const struct iso_extract_options options = iso_extract_options_default();
    assert_int_equal(iso_metric_load(ISOTHERM_SOURCE_DIR "/core/data/face.metric", &metric, &fault),
                     0);
    assert_int_equal(
        iso_head_model_load(ISOTHERM_SOURCE_DIR "/core/data/head.model", &model, &fault), 0);
    assert_int_equal(iso_extractor_new(model, &options, &extractor), 0);
    assert_int_equal(metric->algorithm, iso_extractor_algorithm(extractor));
    iso_extractor_free(extractor);
    iso_head_model_free(model);
    iso_metric_free(metric);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(it_finds_what_tells_people_apart),
        cmocka_unit_test(too_few_people_teach_nothing),
        cmocka_unit_test(a_score_says_how_rare_it_is_among_strangers),
        cmocka_unit_test(a_fused_score_says_how_rare_it_is_among_strangers),
        cmocka_unit_test(people_held_out_teach_no_shape),
        cmocka_unit_test(the_shipped_metric_knows_nobody_who_is_tested),
        cmocka_unit_test(the_shipped_metric_fits_the_shipped_head_model),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
