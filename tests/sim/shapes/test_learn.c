/* Classifiers of other libraries, on features with known classes. */
#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "sim/shapes/learn/learn.h"

enum { CLASSES = 4, EACH = 6, N = CLASSES * EACH, SIZE = 5 };

static const struct iso_feature_layout layout = {SIZE, 1, {SIZE}, ISO_NORM_L1};

struct cloud {
    float feature[N][SIZE];
    int32_t label[N];
    struct iso_labelled all;
};

static void make_cloud(struct cloud *c)
{
    srand48(12);
    for (int i = 0; i < N; i++) {
        c->label[i] = i / EACH;
        for (int k = 0; k < SIZE; k++) {
            double place = 4.0 * cos(1.3 * k * (c->label[i] + 1));
            c->feature[i][k] = (float)(place + 0.5 * (drand48() - 0.5));
        }
    }
    c->all = (struct iso_labelled){&layout, N, CLASSES, c->feature[0], c->label};
}

static void every_kind_tells_clear_classes(void **state)
{
    (void)state;
    struct cloud c;
    double score[N * CLASSES];
    int kinds = 0;
    make_cloud(&c);
    for (const struct iso_classifier_ops *const *ops = iso_learn_classifiers; *ops; ops++) {
        int right = 0;
        assert_int_equal(iso_cross_validate(*ops, &c.all, 3, 1, score), 0);
        for (int i = 0; i < N; i++) {
            int told = 0;
            for (int k = 1; k < CLASSES; k++) {
                told = score[i * CLASSES + k] > score[i * CLASSES + told] ? k : told;
            }
            right += told == c.label[i];
        }
        print_message("%s: %d of %d right\n", (*ops)->name, right, N);
        assert_true(right >= N - 2);
        kinds++;
    }
    if (kinds == 0) {
        skip(); /* neither libsvm nor OpenCV's ml in this build */
    }
}

/* A class without members is never the answer, and nothing is ranked. */
static void a_class_without_members_is_never_the_answer(void **state)
{
    (void)state;
    struct cloud c;
    make_cloud(&c);
    for (int i = 0; i < N; i++) {
        c.label[i] = c.label[i] == 1 ? 2 : c.label[i];
    }
    for (const struct iso_classifier_ops *const *ops = iso_learn_classifiers; *ops; ops++) {
        struct iso_classifier *classifier = NULL;
        double score[CLASSES], distance[N];
        assert_int_equal(iso_classifier_new(*ops, &c.all, &classifier), 0);
        for (int i = 0; i < N; i++) {
            assert_int_equal(iso_classifier_score(classifier, c.feature[i], score), 0);
            assert_true(score[1] < score[c.label[i]]);
        }
        assert_int_equal(iso_classifier_rank(classifier, c.feature[0], -1, distance), -ENOSYS);
        iso_classifier_free(classifier);
    }
}

static void names_are_found(void **state)
{
    (void)state;
    assert_string_equal(iso_learn_find("crc-rls")->name, "crc-rls");
    for (const struct iso_classifier_ops *const *ops = iso_learn_classifiers; *ops; ops++) {
        assert_ptr_equal(iso_learn_find((*ops)->name), *ops);
    }
    assert_null(iso_learn_find("oracle"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_kind_tells_clear_classes),
        cmocka_unit_test(a_class_without_members_is_never_the_answer),
        cmocka_unit_test(names_are_found),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
