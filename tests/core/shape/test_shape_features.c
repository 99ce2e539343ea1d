/* From meshes to features: the part that becomes the shape, the features of each method, and the
 * changes that do not affect them. */
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

#include "core/shape/classify/feature_distance.h"
#include "core/shape/describe/vocabulary.h"
#include "isotherm/shape_method.h"
#include "tests/core/surfaces/shapes.h"
#include "tests/support/near.h"

/* A sphere that is stretched and bent sideways, so that it has no symmetry. */
static struct iso_mesh *pear(int splits, double scale)
{
    struct iso_mesh *mesh = shape_sphere(splits, 10.0);
    for (int32_t v = 0; v < mesh->n_vertices; v++) {
        struct iso_vec3 *p = &mesh->vertices_mm[v];
        double wide = 1.0 + 0.04 * p->z;
        *p = iso_vec3(scale * wide * p->x + scale * 0.02 * p->z * p->z, scale * 0.8 * wide * p->y,
                      scale * 2.0 * p->z);
    }
    return mesh;
}

static struct iso_colour *paint(const struct iso_mesh *mesh)
{
    struct iso_colour *colour = calloc((size_t)mesh->n_vertices, sizeof *colour);
    assert_non_null(colour);
    for (int32_t v = 0; v < mesh->n_vertices; v++) {
        for (int c = 0; c < ISO_CHANNELS; c++) {
            colour[v].channel[c] = (float)(0.5 + 0.5 * sin(0.1 * v + c));
        }
    }
    return colour;
}

/* The mesh has two parts, a single vertex before them, and a triangle without area that would join
 * them. The larger part is the shape, and keeps its own colours. */
static void the_largest_part_is_the_shape(void **state)
{
    (void)state;
    struct iso_mesh *big = pear(2, 1.0), *small = pear(2, 0.5), *all = NULL;
    int32_t nv = big->n_vertices, nt = big->n_triangles;
    assert_int_equal(iso_mesh_new(1 + 2 * nv, 2 * nt + 1, &all), 0);
    all->n_vertices = 1 + 2 * nv;
    all->n_triangles = 2 * nt + 1;
    struct iso_colour *colour = paint(all);
    for (int32_t v = 0; v < nv; v++) {
        all->vertices_mm[1 + v] = small->vertices_mm[v];
        all->vertices_mm[1 + nv + v] = big->vertices_mm[v];
    }
    for (int32_t t = 0; t < nt; t++) {
        for (int k = 0; k < 3; k++) {
            all->triangles[t][k] = 1 + small->triangles[t][k];
            all->triangles[nt + t][k] = 1 + nv + big->triangles[t][k];
        }
    }
    all->vertices_mm[0] = all->vertices_mm[1]; /* this makes the joining triangle a line */
    const int32_t line[3] = {0, 1, 1 + nv};
    memcpy(all->triangles[2 * nt], line, sizeof line);
    struct iso_shape *shape = NULL, *alone = NULL;
    assert_int_equal(iso_shape_new(all, colour, 10, &shape), 0);
    assert_int_equal(iso_shape_new(big, NULL, 10, &alone), 0);
    assert_int_equal(shape->mesh->n_vertices, nv);
    assert_int_equal(shape->mesh->n_triangles, nt);
    assert_near(shape->total_area, iso_mesh_area(big), 1e-9);
    assert_memory_equal(shape->colour, &colour[1 + nv], (size_t)nv * sizeof *colour);
    assert_memory_equal(shape->mesh->triangles, big->triangles, (size_t)nt * sizeof(int32_t[3]));
    for (int i = 0; i < 10; i++) {
        assert_near(shape->pairs->lambda[i], alone->pairs->lambda[i], 1e-9);
    }
    assert_null(alone->weighted[0]);
    assert_int_equal(shape->weighted[2]->k, ISO_SHAPE_WEIGHTED_PAIRS);
    iso_shape_free(shape);
    iso_shape_free(alone);
    free(colour);
    iso_mesh_free(all);
    iso_mesh_free(big);
    iso_mesh_free(small);
}

static void neighbours_and_boundary_are_found(void **state)
{
    (void)state;
    enum { COLUMNS = 9, ROWS = 7 };
    struct iso_mesh *mesh = shape_sheet(COLUMNS, ROWS, 1.0);
    struct iso_shape *shape = NULL;
    assert_int_equal(iso_shape_new(mesh, NULL, 0, &shape), 0);
    assert_int_equal(shape->pairs->k, COLUMNS * ROWS / 2); /* fewer than 100 */
    assert_int_equal(shape->neighbour_start[COLUMNS * ROWS],
                     2 * (shape->stiffness->nnz - COLUMNS * ROWS));
    for (int32_t v = 0; v < COLUMNS * ROWS; v++) {
        int from_side = v % COLUMNS < COLUMNS - 1 - v % COLUMNS ? v % COLUMNS
                                                                : COLUMNS - 1 - v % COLUMNS;
        int from_end = v / COLUMNS < ROWS - 1 - v / COLUMNS ? v / COLUMNS : ROWS - 1 - v / COLUMNS;
        assert_int_equal(shape->near_boundary[v], from_side <= 2 || from_end <= 2);
        for (int32_t at = shape->neighbour_start[v]; at < shape->neighbour_start[v + 1]; at++) {
            int32_t w = shape->neighbour[at];
            assert_true(w != v && abs(w % COLUMNS - v % COLUMNS) <= 1 &&
                        abs(w / COLUMNS - v / COLUMNS) <= 1);
        }
    }
    iso_shape_free(shape);
    iso_mesh_free(mesh);
}

static void impossible_shapes_are_refused(void **state)
{
    (void)state;
    struct iso_mesh *mesh = pear(1, 1.0); /* 42 vertices */
    struct iso_shape *shape = NULL;
    struct iso_colour *colour = paint(mesh);
    assert_int_equal(iso_shape_new(mesh, NULL, -1, &shape), -EINVAL);
    colour[40].channel[1] = 1.01f;
    assert_int_equal(iso_shape_new(mesh, colour, 5, &shape), -EINVAL);
    colour[40].channel[1] = NAN;
    assert_int_equal(iso_shape_new(mesh, colour, 5, &shape), -EINVAL);
    mesh->n_triangles = 8; /* fewer than 32 vertices */
    assert_int_equal(iso_shape_new(mesh, NULL, 5, &shape), -ENODATA);
    mesh->n_triangles = 0;
    assert_int_equal(iso_shape_new(mesh, NULL, 5, &shape), -ENODATA);
    mesh->n_triangles = 1;
    mesh->triangles[0][1] = 42;
    assert_int_equal(iso_shape_new(mesh, NULL, 5, &shape), -EINVAL);
    assert_null(shape);
    iso_shape_free(NULL);
    free(colour);
    iso_mesh_free(mesh);
}

static struct iso_shape *prepare(const struct iso_mesh *mesh)
{
    struct iso_colour *colour = paint(mesh);
    struct iso_shape *shape = NULL;
    assert_int_equal(iso_shape_new(mesh, colour, 0, &shape), 0);
    free(colour);
    return shape;
}

static struct iso_shape_description *describe(const struct iso_shape_method *method,
                                              const struct iso_shape *shape)
{
    struct iso_shape_description *made = NULL;
    assert_int_equal(iso_shape_describe(method, shape, &made), 0);
    return made;
}

/* Returns the features of three shapes by one method, [3][layout size]. Free them with free(). */
static float *features_of(const struct iso_shape_method *method,
                          struct iso_shape_description *const d[3],
                          struct iso_feature_layout *layout)
{
    struct iso_shape_coder *coder = NULL;
    assert_int_equal(iso_shape_coder_new(method, (const struct iso_shape_description *const *)d, 3,
                                         0, 7, &coder),
                     0);
    *layout = *iso_shape_coder_layout(coder);
    float *feature = calloc(3 * (size_t)layout->size, sizeof *feature);
    assert_non_null(feature);
    for (int i = 0; i < 3; i++) {
        assert_int_equal(iso_shape_code(coder, d[i], &feature[i * layout->size]), 0);
    }
    iso_shape_coder_free(coder);
    return feature;
}

/* By L1, except features that only their own norm can compare. */
static double distance_between(const float *a, const float *b,
                               const struct iso_feature_layout *layout)
{
    const enum iso_norm norm = layout->norm == ISO_NORM_PARTIAL ? ISO_NORM_PARTIAL : ISO_NORM_L1;
    double distance = NAN;
    for (int32_t i = 0; i < layout->size; i++) {
        assert_true(isfinite(a[i]) && isfinite(b[i]));
    }
    assert_int_equal(iso_feature_distances(layout, norm, a, b, 1, -1, &distance), 0);
    return distance;
}

/* Asserts that the first two of three shapes agree in every method: their distance is less than
 * `share` of the distance from the first to the third. Frees the meshes. */
static void expect_same(struct iso_mesh *const mesh[3], double share, const char *how)
{
    struct iso_shape *shape[3];
    for (int i = 0; i < 3; i++) {
        shape[i] = prepare(mesh[i]);
    }
    for (const struct iso_shape_method *const *m = iso_shape_methods; *m; m++) {
        struct iso_shape_description *d[3];
        struct iso_feature_layout layout;
        for (int i = 0; i < 3; i++) {
            d[i] = describe(*m, shape[i]);
        }
        float *f = features_of(*m, d, &layout);
        double same = distance_between(f, &f[layout.size], &layout);
        double other = distance_between(f, &f[2 * layout.size], &layout);
        print_message("%-12s %.1e to itself %s, %.1e to another\n", (*m)->name, same, how, other);
        assert_true(same < share * other);
        free(f);
        for (int i = 0; i < 3; i++) {
            iso_shape_description_free(d[i]);
        }
    }
    for (int i = 0; i < 3; i++) {
        iso_shape_free(shape[i]);
        iso_mesh_free(mesh[i]);
    }
}

/* The second shape is three and a half times as large as the first. */
static void size_does_not_matter(void **state)
{
    (void)state;
    struct iso_mesh *const mesh[3] = {pear(3, 1.0), pear(3, 3.5), shape_sphere(3, 10.0)};
    expect_same(mesh, 0.02, "scaled");
}

/* Two parallelograms joined all around, flat: a closed surface that can be rolled without
 * stretching. */
static struct iso_mesh *pillow(int columns, int rows)
{
    struct iso_mesh *sheet = shape_sheet(columns, rows, 1.0), *mesh = NULL;
    int32_t n = sheet->n_vertices, nt = sheet->n_triangles;
    int32_t *back = calloc((size_t)n, sizeof *back);
    assert_non_null(back);
    assert_int_equal(iso_mesh_new(2 * n, 2 * nt, &mesh), 0);
    mesh->n_vertices = n;
    for (int32_t v = 0; v < n; v++) {
        int column = v % columns, row = v / columns;
        bool seam = column == 0 || row == 0 || column == columns - 1 || row == rows - 1;
        mesh->vertices_mm[v] = sheet->vertices_mm[v];
        mesh->vertices_mm[v].x += 0.4 * mesh->vertices_mm[v].y;
        back[v] = seam ? v : mesh->n_vertices++;
        mesh->vertices_mm[back[v]] = mesh->vertices_mm[v];
    }
    for (int32_t t = 0; t < nt; t++) {
        for (int k = 0; k < 3; k++) {
            mesh->triangles[t][k] = sheet->triangles[t][k];
            mesh->triangles[nt + t][k] = back[sheet->triangles[t][2 - k]];
        }
    }
    mesh->n_triangles = 2 * nt;
    free(back);
    iso_mesh_free(sheet);
    return mesh;
}

/* A flat and a rolled pillow, compared with one of another form. Every method treats isometric
 * shapes as equal. */
static void bending_does_not_matter(void **state)
{
    (void)state;
    struct iso_mesh *const mesh[3] = {pillow(37, 15), pillow(37, 15), pillow(26, 21)};
    shape_roll(mesh[1], 15.0);
    expect_same(mesh, 0.2, "bent");
}

/* The sizes are those of the dissertation. */
static void features_have_their_sizes(void **state)
{
    (void)state;
    const struct {
        const char *name;
        int32_t size, parts;
    } expected[] = {{"shape-dna", 15, 1},    {"cp-td", 10099, 1},   {"cp-hk", 700, 8},
                    {"cp-hk-plain", 601, 7}, {"w-hks1", 3 * 64, 3}, {"w-hks2", 3 * 64 + 64, 4}};
    struct iso_mesh *mesh = pear(3, 1.0);
    struct iso_shape *shape = prepare(mesh);
    for (size_t i = 0; i < sizeof expected / sizeof expected[0]; i++) {
        const struct iso_shape_method *method = iso_shape_method_find(expected[i].name);
        assert_non_null(method);
        struct iso_shape_description *d = describe(method, shape), *const same[3] = {d, d, d};
        struct iso_feature_layout layout;
        float *f = features_of(method, same, &layout);
        assert_int_equal(layout.size, expected[i].size);
        assert_int_equal(layout.n_parts, expected[i].parts);
        free(f);
        iso_shape_description_free(d);
    }
    assert_null(iso_shape_method_find("cp"));
    iso_shape_free(shape);
    iso_mesh_free(mesh);
}

static void misfits_are_refused(void **state)
{
    (void)state;
    struct iso_mesh *mesh = pear(2, 1.0);
    struct iso_shape *plain = NULL;
    struct iso_shape_description *out = NULL;
    const struct iso_shape_method *dna = iso_shape_method_find("shape-dna");
    const struct iso_shape_method *bag = iso_shape_method_find("w-hks1");
    assert_int_equal(iso_shape_new(mesh, NULL, 20, &plain), 0);
    assert_int_equal(iso_shape_describe(bag, plain, &out), -ENODATA);
    assert_null(out);
    struct iso_shape *coloured = prepare(mesh);
    struct iso_shape_description *a = describe(dna, coloured), *b = describe(bag, coloured);
    const struct iso_shape_description *const mixed[2] = {a, b};
    struct iso_shape_coder *coder = NULL;
    assert_int_equal(iso_shape_coder_new(dna, mixed, 2, 0, 1, &coder), -EINVAL);
    assert_int_equal(iso_shape_coder_new(dna, mixed, 0, 0, 1, &coder), -EINVAL);
    assert_int_equal(iso_shape_coder_new(bag, &mixed[1], 1, ISO_WORDS_MAX + 1, 1, &coder), -EINVAL);
    assert_null(coder);
    assert_int_equal(iso_shape_coder_new(dna, mixed, 1, 0, 1, &coder), 0);
    float feature[15] = {4.0f};
    assert_int_equal(iso_shape_code(coder, b, feature), -EINVAL);
    assert_near((double)feature[0], 4.0, 0.0);
    iso_shape_coder_free(coder);
    iso_shape_description_free(a);
    iso_shape_description_free(b);
    iso_shape_free(plain);
    iso_shape_free(coloured);
    iso_mesh_free(mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_largest_part_is_the_shape),
        cmocka_unit_test(neighbours_and_boundary_are_found),
        cmocka_unit_test(impossible_shapes_are_refused),
        cmocka_unit_test(size_does_not_matter),
        cmocka_unit_test(bending_does_not_matter),
        cmocka_unit_test(features_have_their_sizes),
        cmocka_unit_test(misfits_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
