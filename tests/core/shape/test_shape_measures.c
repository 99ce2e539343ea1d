/* Retrieval and classification measures, compared with values calculated by hand. */
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

#include "core/shape/classify/confusion.h"
#include "core/shape/classify/retrieval.h"
#include "tests/support/near.h"

/* One query of class 7 and six items. The hits are at the places 1, 3 and 6. */
static const double one_row[6] = {0.1, 0.2, 0.3, 0.4, 0.5, 0.6};
static const int32_t of_seven[1] = {7};
static const int32_t classes[6] = {7, 5, 7, 5, 6, 7};

static void one_query_is_measured_as_by_hand(void **state)
{
    (void)state;
    const struct iso_ranked ranked = {1, 6, one_row, of_seven, classes, NULL, NULL, NULL};
    struct iso_retrieval m;
    assert_int_equal(iso_retrieval_query(&ranked, 0, &m), 0);
    assert_int_equal(m.n_queries, 1);
    assert_near(m.nearest, 1.0, 0.0);
    assert_near(m.first_tier, 2.0 / 3, 1e-12);
    assert_near(m.second_tier, 1.0, 1e-12);
    assert_near(m.e_measure, 2.0 / (1.0 / 0.5 + 1.0), 1e-12); /* all six items count */
    assert_near(m.dcg, (1.0 + 1.0 / log2(3) + 1.0 / log2(6)) / (1.0 + 1.0 + 1.0 / log2(3)), 1e-12);
    assert_near(m.adr, (1.0 + 1.0 / 2 + 2.0 / 3) / 3, 1e-12);
    /* Precision 1 at recall 1/3, 2/3 at 2/3, 1/2 at 1. */
    assert_near(m.precision[5], 1.0, 1e-12);      /* recall 0.30 */
    assert_near(m.precision[6], 2.0 / 3, 1e-12);  /* 0.35 */
    assert_near(m.precision[12], 2.0 / 3, 1e-12); /* 0.65 */
    assert_near(m.precision[13], 0.5, 1e-12);     /* 0.70 */
    assert_near(m.precision[ISO_RECALL_LEVELS - 1], 0.5, 1e-12);
}

/* The first three places count items of class 7. The next places, as many as the wider class has
 * left, count items of the wider class. */
static void dynamic_recall_knows_wider_classes(void **state)
{
    (void)state;
    const int32_t query_wider[1] = {1}, item_wider[6] = {1, 2, 1, 1, 2, 1};
    const struct iso_ranked ranked = {1,       6,           one_row,    of_seven,
                                      classes, query_wider, item_wider, NULL};
    struct iso_retrieval m;
    assert_int_equal(iso_retrieval_query(&ranked, 0, &m), 0);
    assert_near(m.adr, (1.0 + 1.0 / 2 + 2.0 / 3 + 3.0 / 4) / 4, 1e-12);
    assert_near(m.first_tier, 2.0 / 3, 1e-12);
}

/* Five shapes of the classes 0 0 1 1 2, each its own item. The shape of class 2 does not count.
 * Equal distances are sorted by number. */
static void the_mean_is_over_queries_that_count(void **state)
{
    (void)state;
    const double distance[25] = {
        0, 1, 2, 3, 4, /* shape 1 first */
        9, 0, 1, 1, 5, /* shapes 2 and 3, of the other class, before 0 */
        1, 1, 0, 1, 1, /* all equal: 0, 1, 3, 4 */
        4, 3, 2, 0, 1, /* 4, 2, 1, 0 */
        1, 1, 1, 1, 0,
    };
    const int32_t class[5] = {0, 0, 1, 1, 2}, own[5] = {0, 1, 2, 3, 4};
    const struct iso_ranked ranked = {5, 5, distance, class, class, NULL, NULL, own};
    struct iso_retrieval m;
    assert_int_equal(iso_retrieval_measure(&ranked, &m), 0);
    assert_int_equal(m.n_queries, 4);
    assert_near(m.nearest, 0.25, 1e-12);
    assert_near(m.first_tier, 0.25, 1e-12);
    assert_near(m.second_tier, 0.5, 1e-12);
    assert_near(m.dcg, (1.0 + 1.0 / 2 + 1.0 / log2(3) + 1.0) / 4, 1e-12);
}

static void impossible_rankings_are_refused(void **state)
{
    (void)state;
    double distance[6];
    memcpy(distance, one_row, sizeof distance);
    const int32_t own[1] = {6};
    struct iso_ranked ranked = {1, 6, distance, of_seven, classes, NULL, NULL, own};
    struct iso_retrieval m = {.n_queries = 42};
    assert_int_equal(iso_retrieval_measure(&ranked, &m), -EINVAL);
    ranked.own = NULL;
    distance[4] = NAN;
    assert_int_equal(iso_retrieval_measure(&ranked, &m), -EINVAL);
    assert_int_equal(m.n_queries, 42);
}

/* Six items of three classes. The answers are 0 0 1 | 1 0 | 0. */
static void classes_are_counted_as_by_hand(void **state)
{
    (void)state;
    const int32_t label[6] = {0, 0, 0, 1, 1, 2};
    const double score[18] = {
        0.9, 0.1, 0.0, /* 0 as 0 */
        0.8, 0.2, 0.1, /* 0 as 0 */
        0.3, 0.6, 0.2, /* 0 as 1 */
        0.1, 0.7, 0.0, /* 1 as 1 */
        0.3, 0.3, 0.1, /* 1 as 0: the first of equals */
        0.5, 0.0, 0.2, /* 2 as 0 */
    };
    int32_t count[9];
    struct iso_confusion_rates rates[3], mean;
    assert_int_equal(iso_confusion_measure(score, label, 6, 3, count, rates, &mean), 0);
    const int32_t expected[9] = {2, 1, 0, 1, 1, 0, 1, 0, 0};
    assert_memory_equal(count, expected, sizeof expected);
    assert_near(rates[0].tp_rate, 2.0 / 3, 1e-12);
    assert_near(rates[0].fp_rate, 2.0 / 3, 1e-12);
    assert_near(rates[0].precision, 0.5, 1e-12);
    assert_near(rates[1].precision, 0.5, 1e-12);
    assert_near(rates[2].precision, 0.0, 0.0);
    /* The scores 0.9 0.8 0.3 of class 0 against 0.1 0.3 0.5 of the others: 3 + 3 + 1 and a tie. */
    assert_near(rates[0].roc_area, 7.5 / 9, 1e-12);
    assert_near(rates[1].roc_area, (4.0 + 3.0) / 8, 1e-12);
    assert_near(mean.recall, (3 * 2.0 / 3 + 2 * 0.5 + 0) / 6, 1e-12);
    assert_near(mean.precision, (3 * 0.5 + 2 * 0.5 + 0) / 6, 1e-12);
    assert_near(mean.fp_rate, (3 * 2.0 / 3 + 2 * 0.25 + 0) / 6, 1e-12);
}

static void impossible_scores_are_refused(void **state)
{
    (void)state;
    int32_t label[2] = {0, 1};
    double score[4] = {1, 0, 0, 1};
    struct iso_confusion_rates mean;
    assert_int_equal(iso_confusion_measure(score, label, 0, 2, NULL, NULL, &mean), -EINVAL);
    score[3] = NAN;
    assert_int_equal(iso_confusion_measure(score, label, 2, 2, NULL, NULL, &mean), -EINVAL);
    score[3] = INFINITY;
    assert_int_equal(iso_confusion_measure(score, label, 2, 2, NULL, NULL, &mean), 0);
    assert_near(mean.roc_area, 1.0, 0.0);
    label[1] = 2;
    assert_int_equal(iso_confusion_measure(score, label, 2, 2, NULL, NULL, &mean), -EINVAL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_query_is_measured_as_by_hand),
        cmocka_unit_test(dynamic_recall_knows_wider_classes),
        cmocka_unit_test(the_mean_is_over_queries_that_count),
        cmocka_unit_test(impossible_rankings_are_refused),
        cmocka_unit_test(classes_are_counted_as_by_hand),
        cmocka_unit_test(impossible_scores_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
