/* Parts of a shape by persistence: heights that are known, another way to compute them, noise. */
#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "core/shape/describe/persistence.h"
#include "tests/core/surfaces/shapes.h"
#include "tests/support/near.h"

enum { COLUMNS = 30, ROWS = 7, N = COLUMNS * ROWS };

static struct iso_shape *sheet(void)
{
    struct iso_mesh *mesh = shape_sheet(COLUMNS, ROWS, 1.0);
    struct iso_shape *shape = NULL;
    assert_int_equal(iso_shape_new(mesh, NULL, 4, &shape), 0);
    assert_int_equal(shape->mesh->n_vertices, N);
    iso_mesh_free(mesh);
    return shape;
}

/* A ridge along the middle row, with peaks of 5, 3 and 4 in the columns 4, 13 and 23, and valleys
 * of 1 and 2 in the columns 9 and 18; it is linear between them, and falls to 0 at the ends. */
static double ridge(int column, int row)
{
    static const double at[] = {0, 4, 9, 13, 18, 23, COLUMNS - 1}, height[] = {0, 5, 1, 3, 2, 4, 0};
    int k = 1;
    while (column > at[k]) {
        k++;
    }
    const double share = (column - at[k - 1]) / (at[k] - at[k - 1]);
    return height[k - 1] + share * (height[k] - height[k - 1]) - 0.01 * abs(row - ROWS / 2);
}

/* The peak of 3 ends at 2, where it meets that of 4; this one ends at 1. */
static void peaks_persist_down_to_their_pass(void **state)
{
    (void)state;
    struct iso_shape *shape = sheet();
    struct iso_segments segments;
    double f[N];
    const double expected[] = {5.03, 3.0, 1.0};
    const int column[] = {4, 23, 13};
    for (int v = 0; v < N; v++) {
        f[v] = ridge(v % COLUMNS, v / COLUMNS);
    }
    for (int n_segments = 1; n_segments <= 3; n_segments++) {
        assert_int_equal(iso_shape_segments(shape, f, expected[n_segments - 1], &segments), 0);
        assert_int_equal(segments.n_peaks, 3);
        assert_int_equal(segments.n_segments, n_segments);
        for (int p = 0; p < 3; p++) {
            assert_near(segments.peak[p].persistence, expected[p], 1e-12);
            assert_int_equal(segments.peak[p].vertex, ROWS / 2 * COLUMNS + column[p]);
        }
        for (int v = 0; v < N; v++) {
            const int c = v % COLUMNS;
            if (c != 9 && c != 18) { /* a valley belongs to either side */
                const int third = n_segments == 3 ? 2 : 1;
                const int segment = c < 9 ? 0 : c < 18 ? third : 1;
                assert_int_equal(segments.segment[v], n_segments == 1 ? 0 : segment);
            }
        }
        iso_segments_done(&segments);
    }
    iso_shape_free(shape);
}

/* The height of the highest pass from a vertex to a higher one: each vertex has the highest level
 * at which it is reached, improved until nothing changes. */
static double pass_of(const struct iso_shape *shape, const double *f, int32_t from)
{
    double reached[N], best = -INFINITY;
    for (int v = 0; v < N; v++) {
        reached[v] = v == from ? f[v] : -INFINITY;
    }
    for (int changed = 1; changed;) {
        changed = 0;
        for (int v = 0; v < N; v++) {
            for (int at = shape->neighbour_start[v]; at < shape->neighbour_start[v + 1]; at++) {
                const double level = fmin(reached[shape->neighbour[at]], f[v]);
                if (level > reached[v]) {
                    reached[v] = level;
                    changed = 1;
                }
            }
        }
    }
    for (int v = 0; v < N; v++) {
        best = f[v] > f[from] ? fmax(best, reached[v]) : best;
    }
    return best;
}

/* Random heights: each vertex without a higher neighbour is a peak, and its persistence is its
 * height above the highest pass to a higher vertex. */
static void persistence_is_the_height_above_the_highest_pass(void **state)
{
    (void)state;
    struct iso_shape *shape = sheet();
    struct iso_segments segments;
    double f[N], lowest = INFINITY;
    int n_peaks = 0, n_segments = 1;
    srand48(30);
    for (int v = 0; v < N; v++) {
        f[v] = drand48();
        lowest = fmin(lowest, f[v]);
    }
    assert_int_equal(iso_shape_segments(shape, f, 0.3, &segments), 0);
    for (int p = 0; p < segments.n_peaks; p++) {
        const double pass = pass_of(shape, f, segments.peak[p].vertex),
                     height = f[segments.peak[p].vertex];
        assert_near(segments.peak[p].persistence, height - (p ? pass : lowest), 1e-15);
        n_segments += p > 0 && height - pass >= 0.3;
        assert_true(p >= segments.n_segments || segments.segment[segments.peak[p].vertex] == p);
    }
    for (int v = 0; v < N; v++) {
        int higher = 0;
        for (int at = shape->neighbour_start[v]; at < shape->neighbour_start[v + 1]; at++) {
            higher += f[shape->neighbour[at]] > f[v];
        }
        n_peaks += higher == 0;
    }
    print_message("random heights: %d peaks, %d segments\n", segments.n_peaks, segments.n_segments);
    assert_int_equal(segments.n_peaks, n_peaks);
    assert_int_equal(segments.n_segments, n_segments);
    assert_true(n_segments > 3 && n_segments < n_peaks);
    iso_segments_done(&segments);
    iso_shape_free(shape);
}

static void noise_makes_no_segments(void **state)
{
    (void)state;
    struct iso_shape *shape = sheet();
    struct iso_segments segments;
    double f[N];
    srand48(31);
    for (int v = 0; v < N; v++) {
        f[v] = ridge(v % COLUMNS, v / COLUMNS) + 0.4 * (drand48() - 0.5);
    }
    assert_int_equal(iso_shape_segments(shape, f, 0.5, &segments), 0);
    assert_true(segments.n_peaks > 6);
    assert_int_equal(segments.n_segments, 3);
    iso_segments_done(&segments);
    iso_shape_free(shape);
}

static void impossible_requests_are_refused(void **state)
{
    (void)state;
    struct iso_shape *shape = sheet();
    struct iso_segments segments = {0};
    double f[N] = {0.0};
    assert_int_equal(iso_shape_segments(shape, f, -1.0, &segments), -EINVAL);
    assert_int_equal(iso_shape_segments(shape, f, NAN, &segments), -EINVAL);
    f[5] = INFINITY;
    assert_int_equal(iso_shape_segments(shape, f, 1.0, &segments), -EINVAL);
    f[5] = 0.0; /* equal heights: one segment */
    assert_int_equal(iso_shape_segments(shape, f, 0.0, &segments), 0);
    assert_int_equal(segments.n_peaks, 1);
    assert_int_equal(segments.n_segments, 1);
    iso_segments_done(&segments);
    iso_shape_free(shape);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(peaks_persist_down_to_their_pass),
        cmocka_unit_test(persistence_is_the_height_above_the_highest_pass),
        cmocka_unit_test(noise_makes_no_segments),
        cmocka_unit_test(impossible_requests_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
