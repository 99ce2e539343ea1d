/* Heat signatures, critical points and scale-invariant amplitudes, on known surfaces. */
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

#include "core/shape/describe/scale_invariant.h"
#include "isotherm/signature.h"
#include "tests/core/surfaces/shapes.h"
#include "tests/support/near.h"

static struct iso_shape *prepare(const struct iso_mesh *mesh, int32_t n_pairs)
{
    struct iso_shape *shape = NULL;
    assert_int_equal(iso_shape_new(mesh, NULL, n_pairs, &shape), 0);
    return shape;
}

static double *signature_of(const struct iso_shape *shape, const double *t, int n_times)
{
    double *out = calloc((size_t)shape->mesh->n_vertices * (size_t)n_times, sizeof *out);
    assert_non_null(out);
    assert_int_equal(iso_heat_signature(shape->pairs, 0, t, n_times, out), 0);
    return out;
}

/* K(x, x, t) = sum_l (2 l + 1) / (4 pi R^2) exp(-l (l + 1) t / R^2), which is equal at all
 * vertices. */
static void the_signature_of_a_sphere_is_constant(void **state)
{
    (void)state;
    const double radius = 15.0, t[3] = {12.0, 40.0, 200.0};
    struct iso_mesh *mesh = shape_sphere(4, radius);
    struct iso_shape *shape = prepare(mesh, 144);
    double *hks = signature_of(shape, t, 3), off = 0.0;
    for (int j = 0; j < 3; j++) {
        double expected = 0.0;
        for (int l = 0; l < 40; l++) {
            expected += (2 * l + 1) / (4.0 * M_PI * radius * radius) *
                        exp(-l * (l + 1) * t[j] / (radius * radius));
        }
        for (int32_t v = 0; v < mesh->n_vertices; v++) {
            off = fmax(off, fabs(hks[3 * v + j] / expected - 1.0));
        }
    }
    print_message("signature of a sphere: off by %.2f %% at most\n", 100.0 * off);
    assert_true(off < 0.02);
    free(hks);
    iso_shape_free(shape);
    iso_mesh_free(mesh);
}

/* A sheet and the same sheet on a cylinder. */
static void a_bent_sheet_keeps_its_signature(void **state)
{
    (void)state;
    const double t[3] = {4.0, 20.0, 100.0};
    struct iso_mesh *mesh = shape_sheet(37, 29, 1.0);
    struct iso_shape *flat = prepare(mesh, 60);
    shape_roll(mesh, 12.0);
    struct iso_shape *bent = prepare(mesh, 60);
    double *a = signature_of(flat, t, 3), *b = signature_of(bent, t, 3), off = 0.0;
    for (int32_t i = 0; i < 3 * mesh->n_vertices; i++) {
        off = fmax(off, fabs(b[i] / a[i] - 1.0));
    }
    print_message("bent sheet: signature off by %.3f %% at most\n", 100.0 * off);
    assert_true(off < 0.005);
    for (int i = 1; i < 60; i++) {
        assert_near(bent->pairs->lambda[i] / flat->pairs->lambda[i], 1.0, 0.005);
    }
    free(a);
    free(b);
    iso_shape_free(flat);
    iso_shape_free(bent);
    iso_mesh_free(mesh);
}

/* The mean over all other vertices, for each vertex. The heat from a vertex is its column of the
 * kernel: its own entry is the signature, and its integral is 1. */
static void the_mean_signature_is_a_mean(void **state)
{
    (void)state;
    struct iso_mesh *mesh = shape_relief(12.0);
    struct iso_shape *shape = prepare(mesh, 40);
    size_t n = (size_t)mesh->n_vertices;
    const double t = 150.0;
    double *mean = calloc(n, sizeof *mean), *heat = calloc(n, sizeof *heat);
    double *hks = signature_of(shape, &t, 1);
    assert_true(mean && heat);
    assert_int_equal(iso_heat_mean_signature(shape->pairs, t, mean), 0);
    for (int32_t v = 3; v < mesh->n_vertices; v += 17) {
        assert_int_equal(iso_heat_from_vertex(shape->pairs, v, 0, &t, 1, heat), 0);
        double sum = 0.0, total = 0.0;
        for (size_t j = 0; j < n; j++) {
            sum += j == (size_t)v ? 0.0 : heat[j];
            total += heat[j] * shape->area[j];
        }
        assert_near(mean[v], sum / (double)n, 1e-12);
        assert_near(heat[v], hks[v], 1e-12);
        assert_near(total, 1.0, 1e-9);
        assert_int_equal(iso_heat_from_vertex(shape->pairs, v, 1, &t, 1, heat), 0);
        assert_near(hks[v] - heat[v], 1.0 / shape->total_area, 1e-9);
    }
    free(mean);
    free(heat);
    free(hks);
    iso_shape_free(shape);
    iso_mesh_free(mesh);
}

/* Compares the heat from a vertex with its sums over all pairs. The times go from those at which
 * nothing has decayed to those at which all but the first pair has; `stride` gives their order. */
static void check_courses(const struct iso_shape *shape, int32_t first, int stride)
{
    enum { TIMES = 47, SOURCE = 5 };
    const struct iso_eigenpairs *pairs = shape->pairs;
    const size_t n = (size_t)pairs->n;
    double t[TIMES], *heat = calloc(n * TIMES, sizeof *heat);
    assert_non_null(heat);
    for (int j = 0; j < TIMES; j++) {
        t[j] = 1e-3 * shape->total_area * pow(1.3, j * stride % TIMES);
    }
    assert_int_equal(iso_heat_from_vertex(pairs, SOURCE, first, t, TIMES, heat), 0);
    for (size_t v = 0; v < n; v += 13) {
        for (int j = 0; j < TIMES; j++) {
            double sum = 0.0, size = 0.0;
            for (int32_t i = first; i < pairs->k; i++) {
                const double *phi = &pairs->phi[(size_t)i * n];
                const double term = exp(-pairs->lambda[i] * t[j]) * phi[v] * phi[SOURCE];
                sum += term;
                size += fabs(term);
            }
            assert_true(fabs(heat[v * TIMES + (size_t)j] - sum) <= 1e-14 * size);
        }
    }
    free(heat);
}

/* Pairs that have decayed are left out of the sums. */
static void courses_are_the_sums_of_all_pairs(void **state)
{
    (void)state;
    struct iso_mesh *mesh = shape_relief(12.0);
    struct iso_shape *shape = prepare(mesh, 40);
    for (int32_t first = 0; first < 2; first++) {
        check_courses(shape, first, 1);
        check_courses(shape, first, 29);
    }
    iso_shape_free(shape);
    iso_mesh_free(mesh);
}

static void times_are_geometric(void **state)
{
    (void)state;
    double t[5];
    iso_heat_times(0.5, 40.5, 5, t);
    const double expected[] = {0.5, 1.5, 4.5, 13.5, 40.5};
    for (int j = 0; j < 5; j++) {
        assert_near(t[j], expected[j], 1e-12 * expected[j]);
    }
    iso_heat_times_alpha(3.0, 2.0, -1.0, 0.5, 5, t);
    assert_near(t[0], 1.5, 1e-12);
    assert_near(t[4], 6.0, 1e-12);
}

/* A sphere stretched along z has its extrema at its tips. x y on a sphere has its extrema on four
 * diagonals. Those of a sheet are on its boundary and do not count. */
static void tips_are_critical_points(void **state)
{
    (void)state;
    struct iso_mesh *mesh = shape_sphere(3, 10.0);
    struct iso_shape *shape = prepare(mesh, 8);
    double *f = calloc((size_t)mesh->n_vertices, sizeof *f);
    assert_non_null(f);
    for (int32_t v = 0; v < mesh->n_vertices; v++) {
        /* Turned a little, so that no two neighbours are equal. */
        struct iso_vec3 p = mesh->vertices_mm[v];
        f[v] = (p.x + 0.1 * p.z) * (p.y - 0.05 * p.z) + 0.3 * p.x;
    }
    struct iso_critical_points points;
    assert_int_equal(iso_shape_extrema(shape, f, &points), 0);
    assert_int_equal(points.n, 4);
    for (int i = 0; i < 4; i++) {
        struct iso_vec3 p = mesh->vertices_mm[points.vertex[i]];
        assert_true(fabs(p.x) > 5.0 && fabs(p.y) > 5.0 && fabs(p.z) < 5.0);
        assert_true(i == 0 || fabs(f[points.vertex[i]]) <= fabs(f[points.vertex[i - 1]]));
    }
    iso_critical_points_done(&points);
    iso_shape_free(shape);
    for (int32_t v = 0; v < mesh->n_vertices; v++) {
        mesh->vertices_mm[v].z *= 2.5;
    }
    shape = prepare(mesh, 8);
    assert_int_equal(iso_shape_critical_points(shape, &points), 0);
    assert_int_equal(points.n, 2);
    for (int i = 0; i < 2; i++) {
        assert_true(fabs(mesh->vertices_mm[points.vertex[i]].z) > 23.0);
    }
    iso_critical_points_done(&points);
    iso_shape_free(shape);
    iso_mesh_free(mesh);
    mesh = shape_sheet(20, 12, 1.0);
    shape = prepare(mesh, 8);
    assert_int_equal(iso_shape_extrema(shape, &shape->pairs->phi[shape->pairs->n], &points), 0);
    assert_int_equal(points.n, 0);
    iso_critical_points_done(&points);
    assert_int_equal(iso_shape_critical_points(shape, &points), 0);
    assert_int_equal(points.n, 1);
    iso_critical_points_done(&points);
    iso_shape_free(shape);
    iso_mesh_free(mesh);
    free(f);
}

enum { SAMPLES = 140, KEPT = 6 };

/* Samples the signature of one vertex of an elongated sphere of a scale, over 14 octaves of
 * absolute time from 2^tau on. `whole` is the signature. `plain` is the signature without the
 * constant that it approaches, which SI-HK uses, as in describe_critical.c. */
static void sample_courses(double scale, double tau, double *plain, double *whole)
{
    struct iso_mesh *mesh = shape_sphere(3, 10.0);
    double t[SAMPLES], *heat = calloc((size_t)mesh->n_vertices * SAMPLES, sizeof *heat);
    assert_non_null(heat);
    for (int32_t v = 0; v < mesh->n_vertices; v++) {
        mesh->vertices_mm[v].z *= 1.8;
        mesh->vertices_mm[v] = iso_scale(scale, mesh->vertices_mm[v]);
    }
    struct iso_shape *shape = prepare(mesh, 200);
    iso_heat_times_alpha(1.0, 2.0, tau, 0.1, SAMPLES, t);
    assert_int_equal(iso_heat_signature(shape->pairs, 1, t, SAMPLES, heat), 0);
    memcpy(plain, &heat[60 * SAMPLES], SAMPLES * sizeof *plain);
    assert_int_equal(iso_heat_signature(shape->pairs, 0, t, SAMPLES, heat), 0);
    memcpy(whole, &heat[60 * SAMPLES], SAMPLES * sizeof *whole);
    free(heat);
    iso_shape_free(shape);
    iso_mesh_free(mesh);
}

static double relative_error(const float *a, const float *b)
{
    double off = 0.0, size = 0.0;
    for (int w = 0; w < KEPT; w++) {
        off += ((double)a[w] - (double)b[w]) * ((double)a[w] - (double)b[w]);
        size += (double)b[w] * (double)b[w];
    }
    return sqrt(off / size);
}

static void amplitudes_of(const double *plain, const double *whole, float *hk, float *hks)
{
    struct iso_fourier *of_hk = NULL, *of_hks = NULL;
    assert_int_equal(iso_fourier_new(SAMPLES, KEPT, &of_hk), 0);
    assert_int_equal(iso_fourier_new(SAMPLES - 1, KEPT, &of_hks), 0);
    assert_int_equal(iso_si_hk(of_hk, plain, 1, hk), 0);
    assert_int_equal(iso_si_hks(of_hks, whole, 1, hks), 0);
    iso_fourier_free(of_hk);
    iso_fourier_free(of_hks);
}

/* One shape is three times as large as the other, and the absolute times are the same. Each method
 * has its own window of times. A shift leaves the amplitudes unchanged only if the course is
 * periodic in the window, and the course of SI-HK is not quite periodic. */
static void amplitudes_hardly_change_with_scale(void **state)
{
    (void)state;
    double plain[2][SAMPLES], whole[2][SAMPLES];
    float hk[2][KEPT], hks[2][KEPT], unused[KEPT];
    for (int i = 0; i < 2; i++) {
        sample_courses(i ? 3.0 : 1.0, 5.0, plain[i], whole[i]);
        amplitudes_of(plain[i], whole[i], hk[i], unused);
        sample_courses(i ? 3.0 : 1.0, -2.0, plain[i], whole[i]);
        amplitudes_of(plain[i], whole[i], unused, hks[i]);
    }
    double error[2] = {relative_error(hk[1], hk[0]), relative_error(hks[1], hks[0])};
    print_message("three times as large: SI-HK off by %.3f, SI-HKS by %.3f\n", error[0], error[1]);
    assert_true(error[0] < 0.15 && error[1] < 0.15);
}

/* Figure 4.10 of the dissertation. Noise is added to the courses at both scales, relative to their
 * root mean square. The error is the difference from the amplitudes without noise, as the mean of
 * many draws. */
static void less_noise_comes_through_si_hk_than_si_hks(void **state)
{
    (void)state;
    double plain[SAMPLES], whole[SAMPLES], noisy[2][SAMPLES];
    float hk[KEPT], hks[KEPT], noisy_hk[KEPT], noisy_hks[KEPT];
    srand48(410);
    const double level[] = {0.001, 0.01, 0.05, 0.1};
    for (int scale = 1; scale <= 3; scale += 2) {
        sample_courses(scale, -2.0, plain, whole);
        amplitudes_of(plain, whole, hk, hks);
        double size = 0.0;
        for (int j = 0; j < SAMPLES; j++) {
            size += whole[j] * whole[j] / SAMPLES;
        }
        for (int i = 0; i < 4; i++) {
            enum { DRAWS = 40 };
            double error[2] = {0.0, 0.0};
            for (int d = 0; d < DRAWS; d++) {
                for (int j = 0; j < SAMPLES; j++) {
                    double noise = level[i] * sqrt(3.0 * size) * (2.0 * drand48() - 1.0);
                    noisy[0][j] = plain[j] + noise;
                    noisy[1][j] = whole[j] + noise;
                }
                amplitudes_of(noisy[0], noisy[1], noisy_hk, noisy_hks);
                error[0] += relative_error(noisy_hk, hk) / DRAWS;
                error[1] += relative_error(noisy_hks, hks) / DRAWS;
            }
            print_message("scale %d, noise %.3f: SI-HK off by %.4f, SI-HKS by %.4f\n", scale,
                          level[i], error[0], error[1]);
            assert_true(error[0] < error[1]);
        }
    }
}

/* A cosine has one amplitude. The sum of all amplitudes is 1. Shift and factor have no effect. */
static void amplitudes_are_those_of_waves(void **state)
{
    (void)state;
    enum { N = 16 };
    struct iso_fourier *fourier = NULL;
    assert_int_equal(iso_fourier_new(N, N / 2, &fourier), 0);
    double course[2][N];
    for (int j = 0; j < N; j++) {
        course[0][j] = 3.0 + 2.0 * cos(2.0 * M_PI * 3 * j / N);
        course[1][j] = 0.5 * (3.0 + 2.0 * cos(2.0 * M_PI * 3 * (j + 5) / N));
    }
    float out[2][N / 2];
    assert_int_equal(iso_si_hk(fourier, course[0], 2, out[0]), 0);
    for (int w = 0; w < N / 2; w++) {
        const double third = w == 3 ? 0.25 : 0.0, expected = w == 0 ? 0.75 : third;
        assert_near((double)out[0][w], expected, 1e-6);
        assert_near((double)out[1][w], expected, 1e-6);
    }
    memset(course, 0, sizeof course);
    assert_int_equal(iso_si_hk(fourier, course[0], 1, out[0]), 0);
    assert_near((double)out[0][0], 0.0, 0.0);
    iso_fourier_free(fourier);
    assert_int_equal(iso_fourier_new(3, 1, &fourier), -EINVAL);
    assert_int_equal(iso_fourier_new(16, 0, &fourier), -EINVAL);
    assert_int_equal(iso_fourier_new(16, 9, &fourier), -EINVAL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_signature_of_a_sphere_is_constant),
        cmocka_unit_test(a_bent_sheet_keeps_its_signature),
        cmocka_unit_test(the_mean_signature_is_a_mean),
        cmocka_unit_test(courses_are_the_sums_of_all_pairs),
        cmocka_unit_test(times_are_geometric),
        cmocka_unit_test(tips_are_critical_points),
        cmocka_unit_test(amplitudes_hardly_change_with_scale),
        cmocka_unit_test(less_noise_comes_through_si_hk_than_si_hks),
        cmocka_unit_test(amplitudes_are_those_of_waves),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
