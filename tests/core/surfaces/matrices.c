#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "tests/core/surfaces/matrices.h"

struct matrices matrices_of(const struct iso_mesh *mesh, enum iso_mass kind)
{
    struct matrices m = {0};
    int32_t nnz = mesh->n_vertices + 3 * mesh->n_triangles;
    assert_int_equal(iso_symmetric_new(mesh->n_vertices, nnz, &m.stiffness), 0);
    assert_int_equal(iso_symmetric_new(mesh->n_vertices, nnz, &m.mass), 0);
    assert_int_equal(iso_stiffness_mass(mesh, kind, m.stiffness, m.mass), 0);
    return m;
}

void matrices_free(struct matrices *m)
{
    iso_symmetric_free(m->stiffness);
    iso_symmetric_free(m->mass);
}

double matrices_form(const struct iso_symmetric *a, const double *x, const double *y)
{
    double *ay = calloc((size_t)a->n, sizeof *ay), sum = 0.0;
    assert_non_null(ay);
    iso_symmetric_multiply(a, y, ay);
    for (int32_t i = 0; i < a->n; i++) {
        sum += x[i] * ay[i];
    }
    free(ay);
    return sum;
}
