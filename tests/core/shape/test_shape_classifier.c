/* Classifiers, on features with known classes. */
#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "core/shape/classify/dictionary.h"
#include "core/shape/classify/standard.h"
#include "isotherm/classifier.h"
#include "tests/support/near.h"

enum { CLASSES = 3, EACH = 8, N = CLASSES * EACH, SIZE = 12 };

static const struct iso_feature_layout layout = {SIZE, 2, {8, 4}};

struct cloud {
    float feature[N][SIZE];
    int32_t label[N];
    struct iso_labelled all;
};

/* Makes points about three places. The second part of each feature has the noise `noise_of_second`.
 */
static void make_cloud(struct cloud *c, double noise, double noise_of_second)
{
    srand48(97);
    for (int i = 0; i < N; i++) {
        c->label[i] = i % CLASSES;
        for (int k = 0; k < SIZE; k++) {
            double spread = k < 8 ? noise : noise_of_second;
            c->feature[i][k] = (float)(1.0 + cos(1.3 * k * (c->label[i] + 1)) +
                                       spread * (drand48() - 0.5));
        }
    }
    c->all = (struct iso_labelled){&layout, N, CLASSES, c->feature[0], c->label};
}

static int32_t told(const double *score)
{
    int32_t best = 0;
    for (int32_t k = 1; k < CLASSES; k++) {
        best = score[k] > score[best] ? k : best;
    }
    return best;
}

static int right_ones(const double *score, const int32_t *label)
{
    int right = 0;
    for (int i = 0; i < N; i++) {
        right += told(&score[i * CLASSES]) == label[i];
    }
    return right;
}

static void every_kind_tells_clear_classes(void **state)
{
    (void)state;
    struct cloud c;
    double score[N * CLASSES];
    make_cloud(&c, 0.3, 0.3);
    for (const struct iso_classifier_ops *const *ops = iso_classifiers; *ops; ops++) {
        assert_int_equal(iso_cross_validate(*ops, &c.all, 4, 5, score), 0);
        assert_int_equal(right_ones(score, c.label), N);
        assert_int_equal(iso_cross_validate(*ops, &c.all, N, 5, score), 0); /* leave one out */
        assert_int_equal(right_ones(score, c.label), N);
    }
}

/* A classifier that learns from the item that it classifies would be right even on labels without
 * meaning. */
static void no_classifier_learns_from_the_item_that_it_classifies(void **state)
{
    (void)state;
    struct cloud c;
    double score[N * CLASSES];
    make_cloud(&c, 0.3, 0.3);
    for (int i = 0; i < N; i++) { /* the labels do not depend on the features */
        c.label[i] = i / CLASSES % 2;
    }
    for (const struct iso_classifier_ops *const *ops = iso_classifiers; *ops; ops++) {
        assert_int_equal(iso_cross_validate(*ops, &c.all, 8, 5, score), 0);
        int right = right_ones(score, c.label);
        assert_true(right >= N / 8 && right <= 7 * N / 8);
    }
}

/* How much the distances to other items may change when an item is not learnt. Collaborative
 * classifiers learn the mean and the size of the features, but no label, from all items; their
 * code leaves the item out exactly (an_atom_that_is_left_out_is_not_there). */
static double change_of(const struct iso_classifier_ops *ops)
{
    return strncmp(ops->name, "nn", 2) == 0 ? 1e-6 : 0.1;
}

/* The gallery is ranked as if the items that are left out had never been learnt, but for the
 * change_of() the classifier. */
static void omitted_items_are_not_learnt(void **state)
{
    (void)state;
    struct cloud c;
    make_cloud(&c, 1.0, 1.0);
    for (const struct iso_classifier_ops *const *ops = iso_classifiers; *ops; ops++) {
        struct iso_classifier *all = NULL, *rest = NULL;
        double left[N], without[N];
        struct iso_labelled fewer = c.all;
        fewer.n = N - 1; /* all but the last */
        assert_int_equal(iso_classifier_new(*ops, &c.all, &all), 0);
        assert_int_equal(iso_classifier_new(*ops, &fewer, &rest), 0);
        int error = iso_classifier_rank(all, c.feature[N - 1], N - 1, left);
        assert_int_equal(error, (*ops)->rank ? 0 : -ENOSYS);
        if (!error) {
            assert_int_equal(iso_classifier_rank(rest, c.feature[N - 1], -1, without), 0);
            assert_near(left[N - 1], 0.0, 0.0);
            int own = 0;
            for (int i = 0; i < N - 1; i++) {
                assert_near(left[i], without[i], change_of(*ops));
                own += left[i] < left[own] ? i - own : 0;
            }
            assert_int_equal(c.label[own], c.label[N - 1]);
            /* A feature that is not left out is closest to itself. */
            assert_int_equal(iso_classifier_rank(all, c.feature[4], -1, left), 0);
            for (int i = 0; i < N; i++) {
                assert_true(i == 4 || left[i] > left[4]);
            }
        }
        iso_classifier_free(all);
        iso_classifier_free(rest);
    }
}

/* A code without one atom is the same whether the atom is left out or was never there. */
static void an_atom_that_is_left_out_is_not_there(void **state)
{
    (void)state;
    struct cloud c;
    struct iso_dictionary all, rest;
    double product[N], scratch[2 * N], left[N], without[N];
    make_cloud(&c, 1.0, 1.0);
    assert_int_equal(iso_dictionary_init(&all, c.feature[0], N, SIZE, SIZE), 0);
    assert_int_equal(iso_dictionary_init(&rest, c.feature[0], N - 1, SIZE, SIZE), 0);
    iso_dictionary_products(&all, c.feature[N - 1], product);
    assert_near(product[N - 1], all.square[N - 1], 1e-12);
    for (double lambda = 0.1; lambda < 10.0; lambda *= 3.0) {
        iso_dictionary_solve(&all, lambda, product, N - 1, scratch, left);
        iso_dictionary_solve(&rest, lambda, product, -1, scratch, without);
        assert_near(left[N - 1], 0.0, 0.0);
        for (int i = 0; i < N - 1; i++) {
            assert_near(left[i], without[i], 1e-9);
        }
    }
    iso_dictionary_done(&all);
    iso_dictionary_done(&rest);
}

/* Features that are nearly parallel, like spectra: value k is about k + 1, and a class is told by
 * some percents of it. */
static void make_spectra(struct cloud *c)
{
    srand48(98);
    for (int i = 0; i < N; i++) {
        c->label[i] = i % CLASSES;
        for (int k = 0; k < SIZE; k++) {
            const double own = 0.04 * cos(1.3 * k * (c->label[i] + 1));
            c->feature[i][k] = (float)((k + 1) * (1.0 + own + 0.03 * (drand48() - 0.5)));
        }
    }
    c->all = (struct iso_labelled){&layout, N, CLASSES, c->feature[0], c->label};
}

/* What all features have in common does not hide in what they differ. */
static void parallel_features_are_told_apart(void **state)
{
    (void)state;
    struct cloud c;
    double score[N * CLASSES], distance[N];
    make_spectra(&c);
    for (int kind = 2; kind <= 3; kind++) {
        struct iso_classifier *classifier = NULL;
        int nearest = 0;
        assert_int_equal(iso_cross_validate(iso_classifiers[kind], &c.all, N, 5, score), 0);
        assert_int_equal(iso_classifier_new(iso_classifiers[kind], &c.all, &classifier), 0);
        for (int i = 0; i < N; i++) {
            assert_int_equal(iso_classifier_rank(classifier, c.feature[i], i, distance), 0);
            int best = i == 0;
            for (int j = 0; j < N; j++) {
                best = j != i && distance[j] < distance[best] ? j : best;
            }
            nearest += c.label[best] == c.label[i];
        }
        iso_classifier_free(classifier);
        print_message("%s: %d of %d told, %d found\n", iso_classifiers[kind]->name,
                      right_ones(score, c.label), N, nearest);
        assert_int_equal(right_ones(score, c.label), N);
        assert_int_equal(nearest, N);
    }
}

/* Mean, spread and length of standardised features are what the header says. */
static void standard_features_have_no_mean(void **state)
{
    (void)state;
    struct cloud c;
    struct iso_standard s;
    make_cloud(&c, 1.0, 1.0);
    for (int i = 0; i < N; i++) {
        for (int k = 0; k < 8; k++) {
            c.feature[i][k] += 1.0f;
        }
        c.feature[i][3] = 7.0f;         /* the same in all */
        c.feature[i][SIZE - 1] -= 9.0f; /* the second part is not compressed */
    }
    for (int kind = ISO_COMPRESSION_NONE; kind <= ISO_COMPRESSION_LOGARITHM; kind++) {
        double sum[SIZE] = {0.0}, square[2] = {0.0};
        assert_true(iso_standard_compressible(&c.all));
        assert_int_equal(iso_standard_init(&s, &c.all, (enum iso_compression)kind, 2.0), 0);
        assert_int_equal(s.compression[0], kind);
        assert_int_equal(s.compression[1], ISO_COMPRESSION_NONE);
        for (int i = 0; i < N; i++) {
            float feature[SIZE];
            double length = 0.0;
            memcpy(feature, c.feature[i], sizeof feature);
            iso_standard_apply(&s, feature);
            for (int k = 0; k < SIZE; k++) {
                const double x = c.feature[i][k];
                const double to = k >= 8 || kind == ISO_COMPRESSION_NONE ? x
                                  : kind == ISO_COMPRESSION_ROOT         ? sqrt(x)
                                                                         : log1p(x);
                const double z = (to - s.mean[k]) * s.scale[k];
                sum[k] += z;
                square[k >= 8] += z * z / N;
                length += (double)feature[k] * (double)feature[k];
            }
            assert_near(feature[3], 0.0, 0.0);
            assert_near(length, 4.0, 1e-5);
        }
        for (int k = 0; k < SIZE; k++) {
            assert_near(sum[k], 0.0, 1e-5);
        }
        assert_near(square[0], 1.0, 1e-6);
        assert_near(square[1], 1.0, 1e-6);
        iso_standard_done(&s);
    }
}

static void distances_are_norms(void **state)
{
    (void)state;
    struct cloud c;
    make_cloud(&c, 1.0, 1.0);
    for (int norm = 1; norm <= 2; norm++) {
        struct iso_classifier *nearest = NULL;
        double distance[N];
        assert_int_equal(iso_classifier_new(iso_classifiers[norm - 1], &c.all, &nearest), 0);
        assert_string_equal(iso_classifiers[norm - 1]->name, norm == 1 ? "nn-l1" : "nn-l2");
        assert_int_equal(iso_classifier_rank(nearest, c.feature[3], -1, distance), 0);
        double sum = 0.0;
        for (int k = 0; k < SIZE; k++) {
            sum += pow(fabs((double)c.feature[3][k] - (double)c.feature[7][k]), norm);
        }
        assert_near(distance[7], pow(sum, 1.0 / norm), 1e-9);
        iso_classifier_free(nearest);
    }
}

/* The second part is noise. Relaxed coding still finds the class from the first part. */
static void a_part_that_disagrees_is_outvoted(void **state)
{
    (void)state;
    struct cloud c;
    double score[N * CLASSES];
    make_cloud(&c, 0.3, 60.0);
    const struct iso_classifier_ops *rcr = iso_classifiers[3];
    assert_string_equal(rcr->name, "rcr");
    assert_int_equal(iso_cross_validate(rcr, &c.all, N, 5, score), 0);
    print_message("RCR beside noise: %d of %d right\n", right_ones(score, c.label), N);
    assert_true(right_ones(score, c.label) >= N - 3);
}

static void a_class_without_members_is_never_the_answer(void **state)
{
    (void)state;
    struct cloud c;
    make_cloud(&c, 0.3, 0.3);
    struct iso_labelled some = c.all;
    int32_t label[N];
    for (int i = 0; i < N; i++) {
        label[i] = c.label[i] == 1 ? 0 : c.label[i];
    }
    some.label = label;
    for (const struct iso_classifier_ops *const *ops = iso_classifiers; *ops; ops++) {
        struct iso_classifier *classifier = NULL;
        double score[CLASSES];
        assert_int_equal(iso_classifier_new(*ops, &some, &classifier), 0);
        assert_int_equal(iso_classifier_score(classifier, c.feature[1], score), 0);
        assert_true(score[1] == -INFINITY && score[0] > score[2]);
        iso_classifier_free(classifier);
    }
}

static void impossible_requests_are_refused(void **state)
{
    (void)state;
    struct cloud c;
    double score[N * CLASSES] = {42.0};
    make_cloud(&c, 0.3, 0.3);
    const struct iso_classifier_ops *ops = iso_classifiers[0];
    struct iso_classifier *out = NULL;
    struct iso_labelled wrong = c.all;
    wrong.n = 0;
    assert_int_equal(iso_classifier_new(ops, &wrong, &out), -EINVAL);
    wrong = c.all;
    wrong.n_classes = 1;
    assert_int_equal(iso_classifier_new(ops, &wrong, &out), -EINVAL);
    assert_int_equal(iso_cross_validate(ops, &c.all, 1, 5, score), -EINVAL);
    assert_int_equal(iso_cross_validate(ops, &c.all, N + 1, 5, score), -EINVAL);
    c.label[5] = CLASSES;
    assert_int_equal(iso_classifier_new(ops, &c.all, &out), -EINVAL);
    c.label[5] = -1;
    assert_int_equal(iso_cross_validate(ops, &c.all, 3, 5, score), -EINVAL);
    c.label[5] = 2;
    c.feature[N - 1][SIZE - 1] = INFINITY;
    assert_int_equal(iso_classifier_new(ops, &c.all, &out), -EINVAL);
    assert_null(out);
    assert_near(score[0], 42.0, 0.0);
    iso_classifier_free(NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_kind_tells_clear_classes),
        cmocka_unit_test(no_classifier_learns_from_the_item_that_it_classifies),
        cmocka_unit_test(omitted_items_are_not_learnt),
        cmocka_unit_test(an_atom_that_is_left_out_is_not_there),
        cmocka_unit_test(parallel_features_are_told_apart),
        cmocka_unit_test(standard_features_have_no_mean),
        cmocka_unit_test(distances_are_norms),
        cmocka_unit_test(a_part_that_disagrees_is_outvoted),
        cmocka_unit_test(a_class_without_members_is_never_the_answer),
        cmocka_unit_test(impossible_requests_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
