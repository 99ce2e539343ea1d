#include "tests/bench/crowd.h"

#include <math.h>

#include "sim/base/random.h"

enum { SEED = 20, STREAM_PERSON = 1, STREAM_TAKE = 2, TAKES_MAX = 64 };

struct iso_template bench_template(const struct iso_metric *metric, uint64_t person, uint64_t take)
{
    struct sim_random own = sim_random_seeded(SEED, STREAM_PERSON, person);
    struct sim_random noise = sim_random_seeded(SEED, STREAM_TAKE, person * TAKES_MAX + take);
    const float *mean_mm = metric->curve_mm;
    struct iso_template t = {
        .algorithm = metric->algorithm,
        .sensor = "bench",
        .n_radii = (uint16_t)metric->n_radii,
        .n_points = (uint16_t)metric->n_points,
        .n_frames = 1,
        .quality = 1.0f,
    };
    for (int r = 0; r < t.n_radii; r++) {
        t.radius_mm[r] = 10.0f * (float)(r + 1);
        for (int l = 0; l < ISO_LANDMARKS; l++) {
            for (int i = 0; (metric->landmarks >> l & 1) && i < t.n_points; i++) {
                for (int k = 0; k < 3; k++) {
                    const double off_mm = 2.0 * sim_random_normal(&own) +
                                          0.3 * sim_random_normal(&noise);
                    t.points_mm[r][l][i][k] = *mean_mm++ + (float)off_mm;
                }
                t.weight[r][l][i] = 1.0f;
            }
        }
    }
    return t;
}

struct iso_metric_vector bench_vector(const struct iso_metric *metric, uint64_t person,
                                      uint64_t take)
{
    struct sim_random own = sim_random_seeded(SEED, STREAM_PERSON, person);
    struct sim_random noise = sim_random_seeded(SEED, STREAM_TAKE, person * TAKES_MAX + take);
    struct iso_metric_vector one = {.n = 1, .weight = 1.0f}, scaled = {.n = 0};
    for (int d = 0; d < metric->n_dimensions; d++) {
        one.mean[d] = (float)(sqrt((double)metric->between[d]) * sim_random_normal(&own) +
                              sim_random_normal(&noise));
    }
    iso_metric_vector_add(metric, &one, &scaled);
    return scaled;
}
