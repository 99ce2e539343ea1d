/* The file of a metric. The reader returns what was written, and refuses every damaged file. */
#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "tests/core/match/small_metric.h"

static void it_survives_its_bytes(void **state)
{
    (void)state;
    struct iso_metric *m = small_metric(), *back = NULL;
    void *bytes = NULL;
    size_t size = 0;
    assert_int_equal(iso_metric_serialise(m, &bytes, &size), 0);
    assert_int_equal(iso_metric_parse(bytes, size, &back, NULL), 0);
    assert_int_equal(back->algorithm, 77);
    assert_int_equal(back->landmarks, 1 << 1 | 1 << 4);
    assert_int_equal(back->n_origins, 2);
    assert_string_equal(back->origin[1], "train-102");
    assert_true(back->rerank.metric == 0.75f && back->rerank.upper == 1.5f &&
                back->rerank.bias == -0.5f);
    assert_true(back->gain == 0.5f && back->bias == -1.0f && back->weight_min == 0.25f);
    assert_memory_equal(back->curve_mm, m->curve_mm, (size_t)m->n_values * sizeof(float));
    assert_int_equal(back->n_nodes, NODES);
    assert_memory_equal(back->node, m->node, sizeof m->node);
    assert_memory_equal(back->upper_mm, m->upper_mm, NODES * sizeof(float));
    assert_memory_equal(back->between, m->between, DIMENSIONS * sizeof(float));
    assert_memory_equal(back->centre, m->centre, DIMENSIONS * sizeof(float));
    for (int i = 0; i < m->n_values * DIMENSIONS; i++) {
        assert_true(fabsf(back->axis[i] - m->axis[i]) <= 0.5f / 32767.0f + 1e-7f);
    }
    free(bytes);
    iso_metric_free(back);
    iso_metric_free(m);
}

static void damaged_bytes_are_refused(void **state)
{
    (void)state;
    struct iso_metric *m = small_metric(), *none = NULL;
    void *bytes = NULL;
    size_t size = 0;
    assert_int_equal(iso_metric_serialise(m, &bytes, &size), 0);
    for (size_t cut = 0; cut < size; cut++) {
        assert_int_equal(iso_metric_parse(bytes, cut, &none, NULL), -EBADMSG);
    }
    for (size_t at = 0; at < size; at++) {
        struct iso_fault fault = {.text = ""};
        ((uint8_t *)bytes)[at] ^= 0x20;
        assert_int_equal(iso_metric_parse(bytes, size, &none, &fault), -EBADMSG);
        assert_true(fault.text[0] != '\0');
        ((uint8_t *)bytes)[at] ^= 0x20;
    }
    assert_null(none);
    free(bytes);
    iso_metric_free(m);
}

static void metrics_out_of_range_are_refused(void **state)
{
    (void)state;
    struct iso_metric *m = small_metric(), *none = NULL;
    void *bytes = NULL;
    size_t size = 0;
    struct iso_metric shape = *m;
    shape.n_dimensions = ISO_METRIC_DIMENSIONS_MAX + 1;
    assert_int_equal(iso_metric_new(&shape, &none), -EINVAL);
    shape = *m;
    shape.landmarks = 0;
    assert_int_equal(iso_metric_new(&shape, &none), -EINVAL);
    shape = *m;
    shape.node[1] = shape.node[2]; /* nodes rise */
    assert_int_equal(iso_metric_new(&shape, &none), -EINVAL);
    shape = *m;
    shape.node[2] = ISO_UPPER_NODES;
    assert_int_equal(iso_metric_new(&shape, &none), -EINVAL);
    m->axis[4] = NAN;
    assert_int_equal(iso_metric_serialise(m, &bytes, &size), -EINVAL);
    m->axis[4] = 0.0f;
    m->between[1] = -1.0f;
    assert_int_equal(iso_metric_serialise(m, &bytes, &size), -EINVAL);
    m->between[1] = 1.0f;
    m->rerank.upper = -0.1f;
    assert_int_equal(iso_metric_serialise(m, &bytes, &size), -EINVAL);
    assert_null(bytes);
    iso_metric_free(m);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(it_survives_its_bytes),
        cmocka_unit_test(damaged_bytes_are_refused),
        cmocka_unit_test(metrics_out_of_range_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
