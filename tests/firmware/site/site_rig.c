#include "tests/firmware/site/site_rig.h"

#include <math.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "core/match/metric_vector.h"

int site_rig_set_up(void **state)
{
    const struct iso_metric shape = {
        .landmarks = 1,
        .n_radii = 2,
        .n_points = 5,
        .n_dimensions = DIMENSIONS,
        .weight_min = 0.25f,
        .gain = 0.5f,
    };
    struct iso_metric *metric = NULL;
    assert_int_equal(iso_metric_new(&shape, &metric), 0);
    for (int d = 0; d < DIMENSIONS; d++) {
        metric->between[d] = 6.0f / (float)(d + 1);
        metric->axis[2 * d * DIMENSIONS + d] = 1.0f;
    }
    *state = metric;
    return 0;
}

int site_rig_tear_down(void **state)
{
    iso_metric_free(*state);
    return 0;
}

/* The vector of one template of a person. Rows (site_rows.h) keep its numbers without rounding, so
 * that the tests can compare to the bit. */
struct iso_metric_vector site_rig_vector_of(const struct iso_metric *metric, int64_t person, int i)
{
    struct iso_metric_vector vector = {.n = 1};
    struct iso_metric_steps steps;
    for (int d = 0; d < DIMENSIONS; d++) {
        const double own = sin(17.0 * (double)person + 3.0 * d), noise = sin(7.0 * i + 5.0 * d);
        const double exact = 1.5 + 2.0 * own + 0.7 * noise;
        vector.mean[d] = (float)(rint(16.0 * exact) / 16.0);
    }
    iso_metric_steps_fill(metric, &steps);
    iso_metric_vector_judge(metric, &steps, &vector);
    return vector;
}

struct iso_site_index *site_rig_new_index(const struct iso_metric *metric, bool adapt)
{
    struct iso_site_index *site = NULL;
    assert_int_equal(iso_site_index_new(metric, adapt, &site), 0);
    assert_int_equal(iso_site_index_start(site), 0);
    return site;
}

uint64_t site_rig_number_of(int64_t person, int i)
{
    return 100 * (uint64_t)person + (uint64_t)i;
}

void site_rig_add_template_of(struct iso_site_index *site, const struct iso_metric *metric,
                              int64_t person, int i, const char *sensor)
{
    const struct iso_metric_vector vector = site_rig_vector_of(metric, person, i);
    const uint64_t number = site_rig_number_of(person, i);
    assert_int_equal(iso_site_index_reserve(site, 1), 0);
    assert_int_equal(iso_site_index_add(site, person, number, sensor, &vector), 0);
}

void site_rig_add_template(struct iso_site_index *site, const struct iso_metric *metric,
                           int64_t person, int i)
{
    site_rig_add_template_of(site, metric, person, i, SITE_RIG_SENSOR);
}

void site_rig_add_person(struct iso_site_index *site, const struct iso_metric *metric,
                         int64_t person)
{
    for (int i = 0; i < TEMPLATES; i++) {
        site_rig_add_template(site, metric, person, i);
    }
}
