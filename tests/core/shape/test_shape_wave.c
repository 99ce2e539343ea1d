/* The wave kernel signature, the survey of a mesh's parts, and descriptions that methods share. */
#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "core/shape/describe/describe.h"
#include "core/shape/describe/largest_part.h"
#include "isotherm/signature.h"
#include "tests/core/surfaces/shapes.h"
#include "tests/support/near.h"

static struct iso_shape *prepare(const struct iso_mesh *mesh, int32_t n_pairs)
{
    struct iso_shape *shape = NULL;
    assert_int_equal(iso_shape_new(mesh, NULL, n_pairs, &shape), 0);
    return shape;
}

/* On a sphere a particle of any energy is equally likely everywhere: 1 / (4 pi R^2), because the
 * spherical harmonics of one degree have the same sum of squares at all points (Unsoeld). The 144
 * pairs are those of the degrees 0..11. */
static void waves_are_everywhere_on_a_sphere(void **state)
{
    enum { N = 9 };
    const double radius = 15.0;
    struct iso_mesh *mesh = shape_sphere(4, radius);
    struct iso_shape *shape = prepare(mesh, 144);
    double energy[N], spread = 0.0, off = 0.0;
    double *wks = calloc((size_t)mesh->n_vertices * N, sizeof *wks);
    (void)state;
    assert_non_null(wks);
    assert_int_equal(iso_wave_energies(shape->pairs, N, energy, &spread), 0);
    assert_near(energy[0] - 2.0 * spread, log(2.0 / (radius * radius)), 0.01);
    /* Linear elements overestimate the eigenvalues of this mesh by 5 % at degree 11. */
    assert_near(energy[N - 1] + 2.0 * spread, log(11.0 * 12.0 / (radius * radius)), 0.06);
    assert_near(energy[1] - energy[0], spread / 7.0, 1e-12);
    assert_int_equal(iso_wave_signature(shape->pairs, energy, N, spread, wks), 0);
    for (int32_t i = 0; i < N * mesh->n_vertices; i++) {
        off = fmax(off, fabs(wks[i] * 4.0 * M_PI * radius * radius - 1.0));
    }
    print_message("waves on a sphere: off by %.2f %% at most\n", 100.0 * off);
    assert_true(off < 0.06);
    assert_int_equal(iso_wave_energies(shape->pairs, 1, energy, &spread), -EINVAL);
    free(wks);
    iso_shape_free(shape);
    iso_mesh_free(mesh);
}

/* At the energy of the first pair of a long strip the particle is where cos^2(pi x / a) is: the
 * strip's pairs are cosines, of which only the first one is near that energy. */
static void waves_of_a_strip_are_cosines(void **state)
{
    struct iso_mesh *mesh = shape_sheet(61, 7, 1.0);
    struct iso_shape *shape = prepare(mesh, 8);
    const double length = 60.0, area = 60.0 * 6.0;
    const double energy = 2.0 * log(M_PI / length);
    double *wks = calloc((size_t)mesh->n_vertices, sizeof *wks), off = 0.0;
    (void)state;
    assert_non_null(wks);
    double low = mesh->vertices_mm[0].x;
    for (int32_t v = 0; v < mesh->n_vertices; v++) {
        low = fmin(low, mesh->vertices_mm[v].x);
    }
    assert_int_equal(iso_wave_signature(shape->pairs, &energy, 1, 0.1, wks), 0);
    for (int32_t v = 0; v < mesh->n_vertices; v++) {
        const double c = cos(M_PI * (mesh->vertices_mm[v].x - low) / length);
        off = fmax(off, fabs(wks[v] * area - 2.0 * c * c));
    }
    print_message("waves of a strip: off by %.4f at most\n", off);
    assert_true(off < 0.01);
    free(wks);
    iso_shape_free(shape);
    iso_mesh_free(mesh);
}

static void append(struct iso_mesh *mesh, const struct iso_mesh *other, double move)
{
    const int32_t n = mesh->n_vertices;
    assert_int_equal(
        iso_mesh_reserve(mesh, n + other->n_vertices, mesh->n_triangles + other->n_triangles), 0);
    for (int32_t v = 0; v < other->n_vertices; v++) {
        mesh->vertices_mm[mesh->n_vertices++] = iso_add(other->vertices_mm[v],
                                                        iso_vec3(move, 0, 0));
    }
    for (int32_t t = 0; t < other->n_triangles; t++, mesh->n_triangles++) {
        for (int k = 0; k < 3; k++) {
            mesh->triangles[mesh->n_triangles][k] = other->triangles[t][k] + n;
        }
    }
}

/* Of 3 x 4 and 6 x 7 squares the second is taken. A vertex of no triangle and a flat triangle are
 * in neither. */
static void parts_are_surveyed(void **state)
{
    struct iso_mesh *mesh = shape_sheet(4, 5, 1.0), *large = shape_sheet(7, 8, 1.0);
    struct iso_part_survey survey = {0};
    (void)state;
    append(mesh, large, 100.0);
    assert_int_equal(iso_mesh_reserve(mesh, mesh->n_vertices + 1, mesh->n_triangles + 1), 0);
    mesh->vertices_mm[mesh->n_vertices++] = iso_vec3(7, 7, 7);
    int32_t *flat = mesh->triangles[mesh->n_triangles++];
    flat[0] = 0;
    flat[1] = 1;
    flat[2] = 2;
    assert_int_equal(iso_part_survey(mesh, &survey), 0);
    assert_int_equal(survey.n_parts, 2);
    assert_int_equal(survey.n_vertices, 56);
    assert_int_equal(survey.n_triangles, 84);
    assert_int_equal(survey.vertices_left_out, 21);
    assert_int_equal(survey.flat_triangles, 1);
    assert_near(survey.area, 42.0, 1e-9);
    assert_near(survey.area_left_out, 12.0, 1e-9);
    iso_mesh_free(mesh);
    iso_mesh_free(large);
}

static void methods_share_descriptions(void **state)
{
    const struct iso_shape_method *whole = iso_shape_method_find("cp-hk"),
                                  *plain = iso_shape_method_find("cp-hk-plain"),
                                  *dna = iso_shape_method_find("shape-dna");
    struct iso_mesh *mesh = shape_sphere(2, 3.0);
    struct iso_shape *shape = prepare(mesh, 0);
    struct iso_shape_description *a = NULL, *b = NULL, *shared = NULL;
    (void)state;
    assert_int_equal(iso_shape_describe(whole, shape, &a), 0);
    assert_int_equal(iso_shape_describe(plain, shape, &b), 0);
    assert_int_equal(iso_describe_share(plain, whole, a, &shared), 0);
    assert_int_equal(shared->n_parts, 7);
    assert_memory_equal(shared->part_size, b->part_size, sizeof b->part_size);
    assert_memory_equal(shared->whole, b->whole, 601 * sizeof *b->whole);
    iso_shape_description_free(shared);
    shared = NULL;
    assert_int_equal(iso_describe_share(whole, plain, b, &shared), -EINVAL);
    assert_int_equal(iso_describe_share(dna, whole, a, &shared), -EINVAL);
    assert_null(shared);
    iso_shape_description_free(a);
    iso_shape_description_free(b);
    iso_shape_free(shape);
    iso_mesh_free(mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(waves_are_everywhere_on_a_sphere),
        cmocka_unit_test(waves_of_a_strip_are_cosines),
        cmocka_unit_test(parts_are_surveyed),
        cmocka_unit_test(methods_share_descriptions),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
