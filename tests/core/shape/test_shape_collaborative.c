/* What classifiers by collaborative representation learn, and how they rank. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "core/shape/classify/collaborative.h"
#include "tests/core/shape/cloud.h"
#include "tests/support/near.h"

/* The number of items that are ranked before item i. If two distances are equal, the item with the
 * smaller index is ranked first. */
static int place_of(const double *distance, int i)
{
    int place = 0;
    for (int j = 0; j < N; j++) {
        place += distance[j] < distance[i] || (distance[j] == distance[i] && j < i);
    }
    return place;
}

/* No tie decides a place: an item has the same place if the items come in the reverse order. */
static void the_order_of_the_items_does_not_matter(void **state)
{
    (void)state;
    struct cloud c, reversed;
    make_cloud(&c, 1.0, 1.0);
    for (int i = 0; i < N; i++) {
        memcpy(reversed.feature[i], c.feature[N - 1 - i], sizeof c.feature[i]);
        reversed.label[i] = c.label[N - 1 - i];
    }
    label_cloud(&reversed);
    for (const struct iso_classifier_ops *const *ops = iso_classifiers; *ops; ops++) {
        struct iso_classifier *forth = NULL, *back = NULL;
        double a[N], b[N];
        assert_int_equal(iso_classifier_new(*ops, &c.all, &forth), 0);
        assert_int_equal(iso_classifier_new(*ops, &reversed.all, &back), 0);
        for (int left = 0; left < N && (*ops)->rank; left++) {
            const float *feature = c.feature[left];
            assert_int_equal(iso_classifier_rank(forth, feature, left, a), 0);
            assert_int_equal(iso_classifier_rank(back, feature, N - 1 - left, b), 0);
            for (int i = 0; i < N; i++) {
                assert_near(b[N - 1 - i], a[i], 1e-5);
                assert_int_equal(place_of(b, N - 1 - i), place_of(a, i));
            }
        }
        iso_classifier_free(forth);
        iso_classifier_free(back);
    }
}

/* Features that differ from the mean in the opposite direction are farther away than those that do
 * not differ from it: class 0 has a wave, class 1 has noise alone, class 2 has the wave negated. */
static void opposite_features_come_last(void **state)
{
    (void)state;
    struct cloud c;
    srand48(96);
    for (int i = 0; i < N; i++) {
        c.label[i] = i % CLASSES;
        for (int k = 0; k < SIZE; k++) {
            c.feature[i][k] = (float)(3.0 + (1 - c.label[i]) * cos(1.3 * k) +
                                      0.2 * (drand48() - 0.5));
        }
    }
    label_cloud(&c);
    for (int kind = 2; kind <= 3; kind++) {
        struct iso_classifier *classifier = NULL;
        double distance[N];
        assert_int_equal(iso_classifier_new(iso_classifiers[kind], &c.all, &classifier), 0);
        for (int left = 0; left < N; left += CLASSES) {
            double last[CLASSES] = {0.0}, first[CLASSES] = {INFINITY, INFINITY, INFINITY};
            assert_int_equal(iso_classifier_rank(classifier, c.feature[left], left, distance), 0);
            for (int i = 0; i < N; i++) {
                if (i != left) {
                    first[c.label[i]] = fmin(first[c.label[i]], distance[i]);
                    last[c.label[i]] = fmax(last[c.label[i]], distance[i]);
                }
            }
            assert_true(last[0] < first[1] && last[1] < first[2]);
        }
        iso_classifier_free(classifier);
    }
}

/* Every class is in the sample of a set of over 60 shapes, also if their order has a period.
 * Classes 0 and 1 take turns in 150 shapes, class 2 has three shapes, class 3 one, class 4 none. */
static void the_sample_has_shapes_of_every_class(void **state)
{
    (void)state;
    enum { ALL = 154 };
    int32_t label[ALL], sample[ISO_COLLABORATIVE_SAMPLE_MAX], n = 0, count[5] = {0};
    uint8_t seen[ALL] = {0};
    for (int i = 0; i < ALL; i++) {
        label[i] = i < 150 ? i % 2 : i < 153 ? 2 : 3;
    }
    const struct iso_training_set gallery = {.n = ALL, .n_classes = 5, .label = label};
    assert_int_equal(iso_collaborative_sample(&gallery, sample, &n), 0);
    assert_int_equal(n, ISO_COLLABORATIVE_SAMPLE_MAX);
    for (int s = 0; s < n; s++) {
        assert_true(sample[s] >= 0 && sample[s] < ALL && !seen[sample[s]]);
        seen[sample[s]] = 1;
        count[label[sample[s]]]++;
    }
    const int expected[5] = {29, 28, 3, 0, 0};
    int32_t met_of[5] = {0};
    for (int c = 0; c < 5; c++) {
        assert_int_equal(count[c], expected[c]);
    }
    for (int s = 0; s < n;
         s++) { /* shape i of the first two classes is number i / 2 of its class */
        const int32_t class = label[sample[s]], met = met_of[class]++;
        assert_true(s == 0 || sample[s] > sample[s - 1]);
        if (class < 2) { /* 75 shapes in `expected` equal stretches: the middle one of each */
            assert_near(sample[s] / 2, (met + 0.5) * 75.0 / expected[class] - 0.5, 0.5 + 1e-9);
        }
    }
    const struct iso_training_set few = {.n = 5, .n_classes = 2, .label = label};
    assert_int_equal(iso_collaborative_sample(&few, sample, &n), 0);
    assert_int_equal(n, 5);
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
    label_cloud(c);
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

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_order_of_the_items_does_not_matter),
        cmocka_unit_test(opposite_features_come_last),
        cmocka_unit_test(the_sample_has_shapes_of_every_class),
        cmocka_unit_test(an_atom_that_is_left_out_is_not_there),
        cmocka_unit_test(parallel_features_are_told_apart),
        cmocka_unit_test(standard_features_have_no_mean),
        cmocka_unit_test(a_part_that_disagrees_is_outvoted),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
