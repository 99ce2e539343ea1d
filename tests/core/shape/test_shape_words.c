/* The tools that make features: principal components and vocabularies. */
#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "core/shape/describe/principal.h"
#include "core/shape/describe/vocabulary.h"
#include "tests/support/near.h"

/* Vectors in a plane of 9 dimensions: two components are enough to keep distances. */
static void principal_components_span_what_was_learnt(void **state)
{
    (void)state;
    enum { N = 12, SIZE = 9 };
    float vector[N][SIZE], coefficient[N][4];
    const float *row[N];
    for (int i = 0; i < N; i++) {
        row[i] = vector[i];
        for (int j = 0; j < SIZE; j++) {
            vector[i][j] = (float)(5.0 + 3.0 * cos(i) * sin(j) + sin(2.0 * i) * cos(3.0 * j));
        }
    }
    struct iso_principal p;
    assert_int_equal(iso_principal_init(row, N, SIZE, 4, &p), 0);
    assert_int_equal(p.n_components, 2);
    for (int i = 0; i < N; i++) {
        iso_principal_project(&p, vector[i], coefficient[i]);
    }
    for (int i = 1; i < N; i++) {
        double whole = 0.0, reduced = 0.0;
        for (int j = 0; j < SIZE; j++) {
            whole += pow((double)vector[i][j] - (double)vector[0][j], 2.0);
        }
        for (int j = 0; j < 2; j++) {
            reduced += pow((double)coefficient[i][j] - (double)coefficient[0][j], 2.0);
        }
        assert_near(sqrt(reduced), sqrt(whole), 1e-4);
    }
    iso_principal_done(&p);
    assert_int_equal(iso_principal_init(row, 0, SIZE, 4, &p), -EINVAL);
    vector[3][3] = NAN;
    assert_int_equal(iso_principal_init(row, N, SIZE, 4, &p), -EDOM);
}

/* Rows about three places give three words. A bag has the share of each word. */
static void words_are_where_rows_are(void **state)
{
    (void)state;
    enum { N = 300 };
    const float place[3][2] = {{0, 0}, {10, 1}, {-3, 8}};
    static const int place_of[10] = {0, 0, 0, 0, 0, 1, 1, 1, 2, 2};
    static const double share[3] = {0.5, 0.3, 0.2};
    float row[N][2], weight[N], bag[3] = {0};
    srand48(3);
    for (int i = 0; i < N; i++) {
        const int at = place_of[i % 10];
        row[i][0] = place[at][0] + (float)(0.3 * (drand48() - 0.5));
        row[i][1] = place[at][1] + (float)(0.3 * (drand48() - 0.5));
        weight[i] = 1.0f / N;
    }
    struct iso_vocabulary v, again;
    assert_int_equal(iso_vocabulary_init(row[0], N, 2, 3, 11, &v), 0);
    assert_int_equal(iso_vocabulary_init(row[0], N, 2, 3, 11, &again), 0);
    assert_memory_equal(v.word, again.word, 6 * sizeof(float));
    iso_vocabulary_count(&v, row[0], weight, N, bag);
    for (int w = 0; w < 3; w++) {
        int near = -1;
        for (int p = 0; p < 3; p++) {
            near = hypot((double)(v.word[2 * w] - place[p][0]),
                         (double)(v.word[2 * w + 1] - place[p][1])) < 0.1
                       ? p
                       : near;
        }
        assert_true(near >= 0);
        assert_near((double)bag[w], share[near], 1e-3);
    }
    iso_vocabulary_done(&v);
    iso_vocabulary_done(&again);
    assert_int_equal(iso_vocabulary_init(row[0], 0, 2, 3, 11, &v), -EINVAL);
    assert_int_equal(iso_vocabulary_init(row[0], N, 2, 0, 11, &v), -EINVAL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(principal_components_span_what_was_learnt),
        cmocka_unit_test(words_are_where_rows_are),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
