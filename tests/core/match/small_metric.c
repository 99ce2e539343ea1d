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

struct iso_template small_template(const struct iso_metric *m, double turn_rad)
{
    struct iso_template t = {.algorithm = 77, .n_radii = RADII, .n_points = POINTS, .n_frames = 1};
    const float *p = m->curve_mm;
    for (int r = 0; r < RADII; r++) {
        for (int l = 0; l < ISO_LANDMARKS; l++) {
            for (int i = 0; i < POINTS; i++) {
                float *out = t.points_mm[r][l][i];
                t.weight[r][l][i] = 1.0f;
                out[0] = (float)(l * i);
                if (m->landmarks >> l & 1) {
                    out[0] = (float)(cos(turn_rad) * (double)p[0] - sin(turn_rad) * (double)p[1]) +
                             3;
                    out[1] = (float)(sin(turn_rad) * (double)p[0] + cos(turn_rad) * (double)p[1]) -
                             5;
                    out[2] = p[2] + 7.0f;
                    p += 3;
                }
            }
        }
    }
    for (int i = 0; i < NODES; i++) {
        const int row = m->node[i] / ISO_UPPER_COLUMNS, column = m->node[i] % ISO_UPPER_COLUMNS;
        t.upper.kind[row][column] = i == 0 ? ISO_UPPER_FILLED : ISO_UPPER_MEASURED;
        t.upper.z_mm[row][column] = m->upper_mm[i];
    }
    return t;
}
