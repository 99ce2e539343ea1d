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

#include "tests/core/shape/cloud.h"
#include "tests/support/near.h"

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
        cmocka_unit_test(distances_are_norms),
        cmocka_unit_test(a_class_without_members_is_never_the_answer),
        cmocka_unit_test(impossible_requests_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
