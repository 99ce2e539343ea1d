/* Descriptions of shapes by heat at chosen times. */
#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "isotherm/shape_method.h"
#include "tests/core/surfaces/shapes.h"
#include "tests/support/near.h"

/* An ellipsoid of three different axes, with colours. */
static struct iso_shape *make_shape(int splits)
{
    struct iso_mesh *mesh = shape_sphere(splits, 10.0);
    struct iso_colour *colour = calloc((size_t)mesh->n_vertices, sizeof *colour);
    struct iso_shape *shape = NULL;
    assert_non_null(colour);
    for (int32_t v = 0; v < mesh->n_vertices; v++) {
        struct iso_vec3 *p = &mesh->vertices_mm[v];
        *p = iso_vec3(1.3 * p->x + 0.02 * p->z * p->z, 0.8 * p->y, 2.0 * p->z);
        colour[v] = (struct iso_colour){{(float)(v % 3) / 2.0f, (float)(v % 5) / 4.0f, 0.4f}};
    }
    assert_int_equal(iso_shape_new(mesh, colour, 0, &shape), 0);
    free(colour);
    iso_mesh_free(mesh);
    return shape;
}

/* 79 times have those of 40 among them, at every second place, so that every second histogram of
 * CP-TD is the same. Times that a method has anyway change nothing. */
static void times_of_heat_are_chosen(void **state)
{
    enum { BINS = 100 };
    const struct iso_describe_times few = {40, 0.01, 0.3}, many = {79, 0.01, 0.3};
    const struct iso_shape_method *temperatures = iso_shape_method_find("cp-td");
    struct iso_shape *shape = make_shape(3);
    struct iso_shape_description *a = NULL, *b = NULL;
    (void)state;
    assert_int_equal(iso_shape_describe_at(temperatures, shape, &few, &a), 0);
    assert_int_equal(iso_shape_describe_at(temperatures, shape, &many, &b), 0);
    assert_int_equal(a->part_size[0], 40 * BINS + 99);
    assert_int_equal(b->part_size[0], 79 * BINS + 99);
    for (int i = 0; i < 40 * BINS; i++) {
        const int j = i / BINS * 2 * BINS + i % BINS;
        assert_near((double)a->whole[i], (double)b->whole[j], 1e-5);
    }
    iso_shape_description_free(a);
    iso_shape_description_free(b);
    for (const struct iso_shape_method *const *m = iso_shape_methods; *m; m++) {
        struct iso_describe_times own, other = {0, 0.0, 0.4};
        struct iso_shape_description *plain = NULL;
        assert_int_equal(iso_shape_describe(*m, shape, &plain), 0);
        assert_int_equal(iso_shape_method_times(*m, NULL, &own), 0);
        assert_int_equal(iso_shape_describe_at(*m, shape, &own, &a), 0);
        assert_int_equal(iso_shape_describe_at(*m, shape, &other, &b), 0);
        const size_t n = plain->n_bags ? (size_t)plain->n_values : (size_t)plain->part_size[0];
        const float *x = plain->n_bags ? plain->local : plain->whole,
                    *same = plain->n_bags ? a->local : a->whole,
                    *changed = plain->n_bags ? b->local : b->whole;
        assert_memory_equal(x, same, n * sizeof *x);
        assert_int_equal(memcmp(x, changed, n * sizeof *x) != 0, own.n > 0);
        assert_int_equal(own.n > 0, strcmp((*m)->name, "td") && strcmp((*m)->name, "shape-dna") &&
                                        strcmp((*m)->name, "local-heat"));
        iso_shape_description_free(plain);
        iso_shape_description_free(a);
        iso_shape_description_free(b);
    }
    iso_shape_free(shape);
}

static void impossible_times_are_refused(void **state)
{
    static const struct iso_describe_times bad[] = {
        {39, 0.0, 0.0}, {1001, 0.0, 0.0}, {-1, 0.0, 0.0},     {0, -0.1, 0.0},
        {0, 0.3, 0.3},  {0, 0.3, 0.2},    {0, 0.0, INFINITY}, {0, NAN, 0.0},
        {0, 9.0, 0.0},  {0, 0.0, 1e-4},   {0, 0.0, NAN},      {0, INFINITY, 1e300},
    };
    const struct iso_describe_times most = {1000, 1e-3, 10.0}, fewest = {40, 0.0, 0.0};
    struct iso_shape *shape = make_shape(2);
    (void)state;
    for (const struct iso_shape_method *const *m = iso_shape_methods; *m; m++) {
        struct iso_shape_description *d = NULL;
        struct iso_describe_times got = {7, 7.0, 7.0};
        for (size_t i = 0; (*m)->times.n > 0 && i < sizeof bad / sizeof *bad; i++) {
            assert_int_equal(iso_shape_method_times(*m, &bad[i], &got), -EINVAL);
            assert_int_equal(iso_shape_describe_at(*m, shape, &bad[i], &d), -EINVAL);
            assert_null(d);
            assert_int_equal(got.n, 7);
        }
        assert_int_equal(iso_shape_method_times(*m, &fewest, &got), 0);
        assert_int_equal(got.n, (*m)->times.n > 0 ? 40 : 0);
        assert_near(got.last, (*m)->times.last, 0.0);
        assert_int_equal(iso_shape_describe_at(*m, shape, &fewest, &d), 0);
        iso_shape_description_free(d);
        assert_int_equal(iso_shape_describe_at(*m, shape, &most, &d), 0);
        iso_shape_description_free(d);
    }
    iso_shape_free(shape);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(times_of_heat_are_chosen),
        cmocka_unit_test(impossible_times_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
