#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "tests/core/surfaces/reference_heat.h"

enum { TIMES_MAX = 8, DEGREE_MAX = 4000, CG_STEPS_MAX = 200 };

static const double cg_tolerance = 1e-14, coefficient_least = 1e-13;

static double dot(const double *a, const double *b, int32_t n)
{
    double sum = 0.0;
    for (int32_t i = 0; i < n; i++) {
        sum += a[i] * b[i];
    }
    return sum;
}

static double *vector(int32_t n)
{
    double *v = calloc((size_t)n, sizeof *v);
    assert_non_null(v);
    return v;
}

/* Solves B x = b by conjugate gradients with the diagonal as preconditioner. */
static void solve_mass(const struct iso_symmetric *mass, const double *b, double *x)
{
    int32_t n = mass->n;
    double *r = vector(n), *z = vector(n), *p = vector(n), *bp = vector(n);
    memcpy(r, b, (size_t)n * sizeof *r);
    memset(x, 0, (size_t)n * sizeof *x);
    double goal = cg_tolerance * sqrt(dot(b, b, n)), before = 1.0;
    int steps = 0;
    while (sqrt(dot(r, r, n)) > goal) {
        assert_true(++steps < CG_STEPS_MAX);
        for (int32_t i = 0; i < n; i++) {
            z[i] = r[i] / mass->value[mass->column_start[i]];
        }
        double now = dot(r, z, n), turn = steps > 1 ? now / before : 0.0;
        for (int32_t i = 0; i < n; i++) {
            p[i] = z[i] + turn * p[i];
        }
        iso_symmetric_multiply(mass, p, bp);
        double stride = now / dot(p, bp, n);
        for (int32_t i = 0; i < n; i++) {
            x[i] += stride * p[i];
            r[i] -= stride * bp[i];
        }
        before = now;
    }
    free(r);
    free(z);
    free(p);
    free(bp);
}

/* Every eigenvalue of B^-1 L is at most the largest value over single triangles (Fried 1972): 12 /
 * area, for a consistent mass, times the trace of the triangle's stiffness. */
static double largest_eigenvalue_bound(const struct iso_mesh *mesh)
{
    double bound = 0.0;
    for (int32_t t = 0; t < mesh->n_triangles; t++) {
        double area = iso_mesh_triangle_area(mesh, t), squares = 0.0;
        for (int k = 0; k < 3; k++) {
            struct iso_vec3 a = mesh->vertices_mm[mesh->triangles[t][k]];
            struct iso_vec3 b = mesh->vertices_mm[mesh->triangles[t][(k + 1) % 3]];
            squares += iso_dot(iso_sub(b, a), iso_sub(b, a));
        }
        bound = fmax(bound, 12.0 / area * squares / (4.0 * area));
    }
    return bound;
}

/* Computes c[k] such that exp(-z (1 + x)) = sum_k c[k] T_k(x). c[0] is exp(-z) I_0(z), and the
 * others are 2 (-1)^k exp(-z) I_k(z), with the Bessel functions by Miller's downward recurrence.
 * Returns how many coefficients are needed. */
static int coefficients(double z, double c[DEGREE_MAX])
{
    int start = (int)(12.0 * sqrt(z) + 60.0);
    assert_true(start < DEGREE_MAX);
    double above = 0.0, at = 1e-250, sum = 0.0;
    for (int k = start; k >= 0; k--) {
        c[k] = at;
        sum += k > 0 ? 2.0 * at : at;
        double below = above + 2.0 * k / z * at;
        above = at;
        at = below;
    }
    for (int k = 0; k <= start; k++) {
        c[k] *= (k > 0 ? 2.0 : 1.0) * (k % 2 ? -1.0 : 1.0) / sum;
    }
    int n = start + 1;
    while (n > 1 && fabs(c[n - 1]) < coefficient_least) {
        n--;
    }
    return n;
}

void reference_heat(const struct iso_mesh *mesh, const struct matrices *m,
                    struct iso_surface_point source, const double *t_mm2, int n_times, double *out)
{
    assert_true(n_times <= TIMES_MAX);
    static double c[TIMES_MAX][DEGREE_MAX];
    int32_t n = mesh->n_vertices;
    double half = 0.5 * largest_eigenvalue_bound(mesh);
    int terms[TIMES_MAX], terms_most = 0;
    for (int j = 0; j < n_times; j++) {
        terms[j] = coefficients(t_mm2[j] * half, c[j]);
        terms_most = terms[j] > terms_most ? terms[j] : terms_most;
    }
    double *now = vector(n), *before = vector(n), *next = vector(n), *load = vector(n);
    for (int k = 0; k < 3; k++) {
        load[mesh->triangles[source.triangle][k]] += source.weight[k];
    }
    solve_mass(m->mass, load, now);
    memset(out, 0, (size_t)n_times * (size_t)n * sizeof *out);
    for (int k = 0; k < terms_most; k++) {
        for (int j = 0; j < n_times; j++) {
            for (int32_t i = 0; i < n && k < terms[j]; i++) {
                out[(size_t)j * (size_t)n + (size_t)i] += c[j][k] * now[i];
            }
        }
        /* T_{k+1} = 2 x T_k - T_{k-1}, x = B^-1 L / half - 1; T_1 = x T_0 */
        iso_symmetric_multiply(m->stiffness, now, load);
        solve_mass(m->mass, load, next);
        for (int32_t i = 0; i < n; i++) {
            double image = next[i] / half - now[i];
            next[i] = k == 0 ? image : 2.0 * image - before[i];
        }
        double *spare = before;
        before = now;
        now = next;
        next = spare;
    }
    free(now);
    free(before);
    free(next);
    free(load);
}
