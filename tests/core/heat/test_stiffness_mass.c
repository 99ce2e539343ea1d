/* Stiffness and mass matrices, compared with known integrals or with integrals by other methods. */
#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "tests/core/surfaces/matrices.h"
#include "tests/core/surfaces/shapes.h"

static double entry(const struct iso_symmetric *a, int32_t i, int32_t j)
{
    int32_t column = i < j ? i : j, row = i < j ? j : i;
    for (int32_t at = a->column_start[column]; at < a->column_start[column + 1]; at++) {
        if (a->row[at] == row) {
            return a->value[at];
        }
    }
    return 0.0;
}

static struct iso_mesh *one_triangle(struct iso_vec3 a, struct iso_vec3 b, struct iso_vec3 c)
{
    struct iso_mesh *mesh = NULL;
    assert_int_equal(iso_mesh_new(3, 1, &mesh), 0);
    mesh->vertices_mm[0] = a;
    mesh->vertices_mm[1] = b;
    mesh->vertices_mm[2] = c;
    mesh->n_vertices = 3;
    mesh->n_triangles = 1;
    for (int k = 0; k < 3; k++) {
        mesh->triangles[0][k] = k;
    }
    return mesh;
}

/* The triangle with sides 3, 4 and 5: cotangents 0, 3/4 and 4/3, area 6. */
static void a_right_triangle_has_the_entries_of_the_books(void **state)
{
    (void)state;
    struct iso_mesh *mesh = one_triangle(iso_vec3(0, 0, 7), iso_vec3(3, 0, 7), iso_vec3(0, 4, 7));
    struct matrices m = matrices_of(mesh, ISO_MASS_CONSISTENT);
    assert_int_equal(m.stiffness->nnz, 6);
    const double stiffness[3][3] = {
        {2.0 / 3 + 3.0 / 8, -2.0 / 3, -3.0 / 8}, {-2.0 / 3, 2.0 / 3, 0}, {-3.0 / 8, 0, 3.0 / 8}};
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            assert_true(fabs(entry(m.stiffness, i, j) - stiffness[i][j]) < 1e-14);
            assert_true(fabs(entry(m.mass, i, j) - (i == j ? 1.0 : 0.5)) < 1e-14);
        }
    }
    matrices_free(&m);
    m = matrices_of(mesh, ISO_MASS_LUMPED);
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            assert_true(fabs(entry(m.mass, i, j) - (i == j ? 2.0 : 0.0)) < 1e-14);
        }
    }
    assert_int_equal(m.mass->nnz, m.stiffness->nnz);
    matrices_free(&m);
    iso_mesh_free(mesh);
}

/* The integrals of phi_i phi_j by Monte Carlo and of grad phi_i . grad phi_j in closed form, over a
 * triangle in general position. */
static void entries_are_the_integrals_that_they_stand_for(void **state)
{
    (void)state;
    struct iso_vec3 p[3] = {{2, -1, 4}, {9, 3, -2}, {-3, 5, 6}};
    struct iso_mesh *mesh = one_triangle(p[0], p[1], p[2]);
    struct matrices m = matrices_of(mesh, ISO_MASS_CONSISTENT);
    struct iso_vec3 u = iso_sub(p[1], p[0]), v = iso_sub(p[2], p[0]);
    double area = 0.5 * iso_norm(iso_cross(u, v));
    enum { SAMPLES = 400000 };
    double sum[3][3] = {{0}};
    srand48(20130601);
    for (int s = 0; s < SAMPLES; s++) {
        double a = drand48(), b = drand48();
        if (a + b > 1.0) {
            a = 1.0 - a;
            b = 1.0 - b;
        }
        const double phi[3] = {1.0 - a - b, a, b};
        for (int i = 0; i < 3; i++) {
            for (int j = 0; j < 3; j++) {
                sum[i][j] += phi[i] * phi[j] * area / SAMPLES;
            }
        }
    }
    /* Gradients in the triangle's own plane: e1 along u, e2 across. */
    struct iso_vec3 e1 = iso_unit(u);
    struct iso_vec3 e2 = iso_unit(iso_madd(v, -iso_dot(v, e1), e1));
    double ux = iso_norm(u), vx = iso_dot(v, e1), vy = iso_dot(v, e2);
    const double gradient[3][2] = {
        {-1.0 / ux, -(1.0 - vx / ux) / vy}, {1.0 / ux, -vx / (ux * vy)}, {0.0, 1.0 / vy}};
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            assert_true(fabs(entry(m.mass, i, j) / sum[i][j] - 1.0) < 0.01);
            double dot = gradient[i][0] * gradient[j][0] + gradient[i][1] * gradient[j][1];
            assert_true(fabs(entry(m.stiffness, i, j) - area * dot) < 1e-12);
        }
    }
    matrices_free(&m);
    iso_mesh_free(mesh);
}

/* On a sheet with the coordinates (s, y), flat or rolled, u = 2 s - 3 y + 1 has the gradient energy
 * 13 per area. On the flat sheet the consistent mass gives the integral of u^2 exactly. */
static void linear_functions_are_integrated_exactly(void **state)
{
    (void)state;
    struct iso_mesh *mesh = shape_sheet(13, 8, 0.5);
    int32_t n = mesh->n_vertices;
    double u[13 * 8], one[13 * 8], image[13 * 8];
    for (int32_t i = 0; i < n; i++) {
        u[i] = 2.0 * mesh->vertices_mm[i].x - 3.0 * mesh->vertices_mm[i].y + 1.0;
        one[i] = 1.0;
    }
    double wide = 6.0, high = 3.5, area = wide * high;
    struct matrices m = matrices_of(mesh, ISO_MASS_CONSISTENT);
    assert_true(fabs(matrices_form(m.stiffness, u, u) - 13.0 * area) < 1e-10);
    assert_true(fabs(matrices_form(m.mass, one, one) - area) < 1e-12);
    double square = area * (4.0 * wide * wide / 12.0 + 9.0 * high * high / 12.0 + 1.0);
    assert_true(fabs(matrices_form(m.mass, u, u) - square) < 1e-10);
    iso_symmetric_multiply(m.stiffness, one, image);
    for (int32_t i = 0; i < n; i++) {
        assert_true(fabs(image[i]) < 1e-13);
    }
    iso_symmetric_multiply(m.stiffness, u, image); /* harmonic: zero inside */
    for (int32_t i = 0; i < n; i++) {
        bool rim = i % 13 == 0 || i % 13 == 12 || i / 13 == 0 || i / 13 == 7;
        assert_true(rim || fabs(image[i]) < 1e-12);
    }
    matrices_free(&m);
    /* On the cylinder the triangles become chords, so that the values agree up to (pitch /
     * radius)^2. */
    shape_roll(mesh, 40.0);
    m = matrices_of(mesh, ISO_MASS_LUMPED);
    assert_true(fabs(matrices_form(m.stiffness, u, u) / (13.0 * area) - 1.0) < 1e-4);
    assert_true(fabs(matrices_form(m.mass, one, one) / area - 1.0) < 1e-4);
    matrices_free(&m);
    iso_mesh_free(mesh);
}

/* The header promises this pattern: diagonal first, rows rising, one entry for each edge, the same
 * for both matrices. */
static void columns_are_sorted_and_complete(void **state)
{
    (void)state;
    struct iso_mesh *mesh = shape_sphere(2, 5.0);
    struct matrices m = matrices_of(mesh, ISO_MASS_LUMPED);
    const struct iso_symmetric *a = m.stiffness, *b = m.mass;
    assert_int_equal(a->nnz, mesh->n_vertices + 3 * mesh->n_triangles / 2);
    assert_int_equal(a->column_start[a->n], a->nnz);
    for (int32_t j = 0; j < a->n; j++) {
        assert_int_equal(a->row[a->column_start[j]], j);
        for (int32_t at = a->column_start[j] + 1; at < a->column_start[j + 1]; at++) {
            assert_true(a->row[at] > a->row[at - 1]);
            assert_int_equal(b->row[at], a->row[at]);
        }
        assert_int_equal(b->column_start[j], a->column_start[j]);
    }
    /* A second fill with a smaller mesh leaves nothing of the larger one. */
    struct iso_mesh *small = shape_sphere(1, 5.0);
    assert_int_equal(iso_stiffness_mass(small, ISO_MASS_CONSISTENT, m.stiffness, m.mass), 0);
    struct matrices fresh = matrices_of(small, ISO_MASS_CONSISTENT);
    assert_int_equal(m.stiffness->nnz, fresh.stiffness->nnz);
    size_t bytes = (size_t)fresh.stiffness->nnz * sizeof(double);
    assert_memory_equal(m.stiffness->value, fresh.stiffness->value, bytes);
    assert_memory_equal(m.mass->value, fresh.mass->value, bytes);
    matrices_free(&fresh);
    matrices_free(&m);
    iso_mesh_free(small);
    iso_mesh_free(mesh);
}

static void slivers_and_lone_vertices_do_no_harm(void **state)
{
    (void)state;
    struct iso_mesh *mesh = NULL;
    assert_int_equal(iso_mesh_new(7, 3, &mesh), 0);
    const struct iso_vec3 p[7] = {{0, 0, 0}, {3, 0, 0}, {0, 4, 0}, {1, 0, 0},
                                  {2, 0, 0}, {9, 9, 9}, {5, 5, 5}};
    for (int i = 0; i < 7; i++) {
        mesh->vertices_mm[i] = p[i];
    }
    mesh->n_vertices = 7;
    mesh->n_triangles = 2;
    const int32_t triangles[2][3] = {{0, 1, 2}, {0, 3, 4}}; /* the second one has no area */
    for (int t = 0; t < 2; t++) {
        for (int k = 0; k < 3; k++) {
            mesh->triangles[t][k] = triangles[t][k];
        }
    }
    struct matrices m = matrices_of(mesh, ISO_MASS_CONSISTENT);
    assert_true(fabs(entry(m.stiffness, 0, 0) - (2.0 / 3 + 3.0 / 8)) < 1e-14);
    assert_true(entry(m.stiffness, 0, 3) == 0.0);
    for (int i = 3; i < 7; i++) {
        assert_true(entry(m.mass, i, i) == 1.0);
        assert_true(entry(m.stiffness, i, i) == 0.0);
    }
    matrices_free(&m);
    iso_mesh_free(mesh);
}

static void matrices_and_meshes_that_do_not_fit_are_refused(void **state)
{
    (void)state;
    struct iso_symmetric *none = NULL;
    assert_int_equal(iso_symmetric_new(0, 10, &none), -EINVAL);
    assert_int_equal(iso_symmetric_new(10, 9, &none), -EINVAL);
    assert_null(none);
    iso_symmetric_free(NULL);
    struct iso_mesh *mesh = shape_sheet(4, 3, 1.0);
    int32_t n = mesh->n_vertices, nnz = n + 3 * mesh->n_triangles;
    struct iso_symmetric *large, *short_n, *short_nnz;
    assert_int_equal(iso_symmetric_new(n, nnz, &large), 0);
    assert_int_equal(iso_symmetric_new(n - 1, nnz, &short_n), 0);
    assert_int_equal(iso_symmetric_new(n, n, &short_nnz), 0);
    assert_int_equal(iso_stiffness_mass(mesh, ISO_MASS_LUMPED, short_n, large), -ENOSPC);
    assert_int_equal(iso_stiffness_mass(mesh, ISO_MASS_LUMPED, large, short_n), -ENOSPC);
    assert_int_equal(iso_stiffness_mass(mesh, ISO_MASS_LUMPED, short_nnz, large), -ENOSPC);
    assert_int_equal(iso_stiffness_mass(mesh, ISO_MASS_LUMPED, large, short_nnz), -ENOSPC);
    mesh->triangles[3][0] = n;
    assert_int_equal(iso_stiffness_mass(mesh, ISO_MASS_LUMPED, large, large), -EINVAL);
    iso_symmetric_free(large);
    iso_symmetric_free(short_n);
    iso_symmetric_free(short_nnz);
    iso_mesh_free(mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_right_triangle_has_the_entries_of_the_books),
        cmocka_unit_test(entries_are_the_integrals_that_they_stand_for),
        cmocka_unit_test(linear_functions_are_integrated_exactly),
        cmocka_unit_test(columns_are_sorted_and_complete),
        cmocka_unit_test(slivers_and_lone_vertices_do_no_harm),
        cmocka_unit_test(matrices_and_meshes_that_do_not_fit_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
