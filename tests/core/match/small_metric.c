#include "tests/core/match/small_metric.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

struct iso_metric *small_metric(void)
{
    const struct iso_metric shape = {
        .algorithm = 77,
        .landmarks = 1U << 1 | 1U << 4,
        .n_radii = RADII,
        .n_points = POINTS,
        .n_dimensions = DIMENSIONS,
        .n_nodes = NODES,
        .node = {3, 2 * ISO_UPPER_COLUMNS + 1, ISO_UPPER_NODES - 1},
        .weight_min = 0.25f,
        .gain = 0.5f,
        .bias = -1.0f,
        .rerank = {.metric = 0.75f, .upper = 1.5f, .bias = -0.5f},
        .n_origins = 2,
        .origin = {"train-101", "train-102"},
    };
    struct iso_metric *m = NULL;
    assert_int_equal(iso_metric_new(&shape, &m), 0);
    assert_int_equal(m->n_curve_values, 3 * RADII * 2 * POINTS);
    assert_int_equal(m->n_values, 3 * RADII * 2 * POINTS + NODES);
    for (int v = 0; v < m->n_values; v++) {
        m->curve_mm[v] = 20.0f * (float)sin(1.7 * v) + (float)(v % 7);
        for (int d = 0; d < DIMENSIONS; d++) {
            m->axis[v * DIMENSIONS + d] = (float)cos(0.3 * v * (d + 1));
        }
    }
    for (int d = 0; d < DIMENSIONS; d++) {
        m->between[d] = 8.0f / (float)(d + 1);
        m->centre[d] = 0.125f * (float)d;
    }
    return m;
}
