/* The grid heat solver: its operator is that of the mesh, its columns are those of the plane, and
 * nobody's turn or threads change them. */
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

#include "core/base/lanes.h"
#include "core/heat/grid/chebyshev.h"
#include "core/heat/grid/grid_step.h"
#include "core/heat/grid/heat_grid.h"
#include "tests/core/surfaces/grid_surface.h"
#include "tests/core/surfaces/matrices.h"
#include "tests/core/surfaces/tasks_backwards.h"

static float *new_plane(const struct iso_grid *grid)
{
    float *plane = calloc(iso_grid_plane_size(grid), sizeof *plane);
    assert_non_null(plane);
    return plane + iso_grid_plane_origin(grid);
}

static void free_plane(const struct iso_grid *grid, float *plane)
{
    free(plane - iso_grid_plane_origin(grid));
}

static struct iso_heat_grid *new_solver(const struct grid_surface *s, int n_sources, int n_times,
                                        int n_workers)
{
    const struct iso_heat_grid_options options = {n_sources, n_times, n_workers};
    struct iso_heat_grid *solver = NULL;
    assert_int_equal(iso_heat_grid_new(s->grid, &options, &solver), 0);
    return solver;
}

/* Whole rows, in whole groups of lanes. */
static struct iso_grid_window everything(const struct iso_grid *grid)
{
    return (struct iso_grid_window){0, 0, (grid->width + ISO_LANES - 1) / ISO_LANES * ISO_LANES,
                                    grid->height};
}

/* Any values at the vertices. */
static float *any_values(const struct grid_surface *s)
{
    float *y = new_plane(s->grid);
    for (int32_t i = 0; i < s->mesh->n_vertices; i++) {
        y[s->plane_index[i]] = (float)sin(1.0 + 12.9898 * i);
    }
    return y;
}

static void the_operator_is_that_of_the_mesh(void **state)
{
    (void)state;
    struct grid_surface s = grid_surface_hills(2.0, 1.0);
    struct matrices m = matrices_of(s.mesh, ISO_MASS_LUMPED);
    struct iso_grid_stencil *stencil = NULL;
    assert_int_equal(iso_grid_stencil_new(s.grid, &stencil), 0);
    iso_grid_stencil_build(stencil, s.grid, everything(s.grid));
    size_t n = (size_t)s.mesh->n_vertices;
    float *y = any_values(&s), *image = new_plane(s.grid);
    double *x = calloc(n, sizeof *x), *expected = calloc(n, sizeof *expected);
    assert_true(x && expected);
    for (size_t i = 0; i < n; i++) {
        double mass = m.mass->value[m.mass->column_start[i]];
        assert_true(fabs((double)stencil->root[s.plane_index[i]] * sqrt(mass) - 1.0) < 1e-6);
        x[i] = (double)y[s.plane_index[i]] / sqrt(mass);
    }
    iso_symmetric_multiply(m.stiffness, x, expected);
    const struct iso_grid_step once = {
        .window = everything(s.grid), .forth = 1.0f, .y = y, .io = image};
    iso_grid_stepper().sweep(stencil, &once, 1);
    for (size_t i = 0; i < n; i++) {
        double mass = m.mass->value[m.mass->column_start[i]];
        double off = (double)image[s.plane_index[i]] - expected[i] / sqrt(mass);
        assert_true(fabs(off) < 2e-5);
    }
    free(x);
    free(expected);
    free_plane(s.grid, y);
    free_plane(s.grid, image);
    iso_grid_stencil_free(stencil);
    matrices_free(&m);
    grid_surface_done(&s);
}

static double norm(const struct iso_grid *grid, const float *plane)
{
    double square = 0.0;
    for (int i = 0; i < grid->height * grid->stride; i++) {
        square += (double)plane[i] * (double)plane[i];
    }
    return sqrt(square);
}

static void the_bound_holds_and_is_close(void **state)
{
    (void)state;
    for (int steep = 0; steep < 2; steep++) {
        struct grid_surface s = grid_surface_hills(2.0, steep);
        struct iso_grid_stencil *stencil = NULL;
        assert_int_equal(iso_grid_stencil_new(s.grid, &stencil), 0);
        iso_grid_stencil_build(stencil, s.grid, everything(s.grid));
        const struct iso_grid_window all = everything(s.grid);
        float *now = any_values(&s), *next = new_plane(s.grid);
        double largest = 0.0;
        for (int i = 0; i < 300; i++) { /* power iteration */
            memset(next - iso_grid_plane_origin(s.grid), 0,
                   iso_grid_plane_size(s.grid) * sizeof *next);
            const struct iso_grid_step once = {
                .window = all, .forth = (float)(1.0 / norm(s.grid, now)), .y = now, .io = next};
            iso_grid_stepper().sweep(stencil, &once, 1);
            largest = norm(s.grid, next);
            float *spare = now;
            now = next;
            next = spare;
        }
        double bound = iso_grid_stencil_bound(stencil, all);
        print_message("steepness %d: largest eigenvalue %.3f, bound %.3f\n", steep, largest, bound);
        assert_true(bound > largest && bound < 1.7 * largest);
        free_plane(s.grid, now);
        free_plane(s.grid, next);
        iso_grid_stencil_free(stencil);
        grid_surface_done(&s);
    }
}

/* In whatever order its bands are built, for windows so low that some bands have no row. */
static void bands_make_the_same_operator_in_any_order(void **state)
{
    (void)state;
    enum { PLANES = 7 };
    struct grid_surface s = grid_surface_hills(2.0, 1.0);
    struct iso_grid_stencil *forth = NULL, *back = NULL;
    assert_int_equal(iso_grid_stencil_new(s.grid, &forth), 0);
    assert_int_equal(iso_grid_stencil_new(s.grid, &back), 0);
    for (int row = 0; row < 10; row++) {
        for (int height = 1; row + height <= s.grid->height && height < 60; height++) {
            const struct iso_grid_window window = {ISO_LANES, row, 2 * ISO_LANES, height};
            iso_grid_stencil_build(forth, s.grid, window);
            for (int step = 0; step < ISO_GRID_STENCIL_STEPS; step++) {
                for (int band = ISO_GRID_STENCIL_BANDS - 1; band >= 0; band--) {
                    iso_grid_stencil_build_band(back, s.grid, window, step, band);
                }
            }
            assert_true(iso_grid_stencil_bound(forth, window) > 0.0);
            assert_memory_equal(forth->memory, back->memory,
                                PLANES * forth->plane_size * sizeof(float));
        }
    }
    iso_grid_stencil_free(forth);
    iso_grid_stencil_free(back);
    grid_surface_done(&s);
}

/* Vectors of a recurrence and two sums: four planes. */
struct vectors {
    float *plane[4];
};

static struct vectors any_vectors(const struct grid_surface *s)
{
    return (struct vectors){
        {any_values(s), new_plane(s->grid), new_plane(s->grid), new_plane(s->grid)}};
}

/* Steps whose windows grow, of odd and even heights, with loads and sums. */
static void describe_steps(const struct iso_grid *grid, const struct vectors *v,
                           struct iso_grid_step step[ISO_GRID_STEPS_MAX])
{
    const struct iso_grid_window all = everything(grid);
    for (int s = 0; s < ISO_GRID_STEPS_MAX; s++) {
        const bool last = s + 1 == ISO_GRID_STEPS_MAX;
        const int rest = last ? 0 : 9 - 2 * s - s % 2;
        const ptrdiff_t at = (all.height / 2 + s) * grid->stride + all.width / 2;
        step[s] = (struct iso_grid_step){
            .window = last ? all
                           : (struct iso_grid_window){0, rest, ISO_LANES * (2 + s),
                                                      all.height - 2 * rest},
            .forth = 0.7f,
            .back = -2.0f,
            .y = v->plane[s % 2],
            .io = v->plane[1 - s % 2],
            .load = {2, {at, at + grid->stride + 1}, {3.0f, -1.5f}},
            .sums = {2, {0.3f, 0.2f}, {v->plane[2], v->plane[3]}},
        };
    }
}

static void assert_same_vectors(const struct iso_grid *grid, const struct vectors *a,
                                const struct vectors *b)
{
    for (int k = 0; k < 4; k++) {
        assert_true(norm(grid, a->plane[k]) > 1.0);
        assert_memory_equal(a->plane[k], b->plane[k],
                            (size_t)(grid->height * grid->stride) * sizeof(float));
    }
}

static void free_vectors(const struct iso_grid *grid, const struct vectors *v)
{
    for (int k = 0; k < 4; k++) {
        free_plane(grid, v->plane[k]);
    }
}

/* In one pass or in four, by any processor. */
static void a_sweep_is_its_steps_to_the_bit(void **state)
{
    (void)state;
    iso_grid_sweep *sweeps[] = {
        iso__grid_sweep_baseline,
#if defined __x86_64__
        __builtin_cpu_supports("avx2") ? iso__grid_sweep_avx2 : iso__grid_sweep_baseline,
#endif
    };
    struct grid_surface s = grid_surface_hills(2.0, 1.0);
    struct iso_grid_stencil *stencil = NULL;
    assert_int_equal(iso_grid_stencil_new(s.grid, &stencil), 0);
    iso_grid_stencil_build(stencil, s.grid, everything(s.grid));
    struct iso_grid_step step[ISO_GRID_STEPS_MAX];
    const struct vectors one_by_one = any_vectors(&s);
    describe_steps(s.grid, &one_by_one, step);
    for (int k = 0; k < ISO_GRID_STEPS_MAX; k++) {
        iso__grid_sweep_baseline(stencil, &step[k], 1);
    }
    for (size_t i = 0; i < sizeof sweeps / sizeof *sweeps; i++) {
        for (int n = 1; n <= ISO_GRID_STEPS_MAX; n++) {
            const struct vectors v = any_vectors(&s);
            describe_steps(s.grid, &v, step);
            for (int k = 0; k < ISO_GRID_STEPS_MAX; k += n) {
                const int left = ISO_GRID_STEPS_MAX - k;
                sweeps[i](stencil, &step[k], left < n ? left : n);
            }
            assert_same_vectors(s.grid, &one_by_one, &v);
            free_vectors(s.grid, &v);
        }
    }
    free_vectors(s.grid, &one_by_one);
    iso_grid_stencil_free(stencil);
    grid_surface_done(&s);
}

static void the_expansion_is_the_exponential(void **state)
{
    (void)state;
    static double c[ISO_CHEBYSHEV_TERMS_MAX];
    const double z[] = {0.01, 0.5, 20.0, 112.5, 1750.0};
    for (size_t i = 0; i < sizeof z / sizeof z[0]; i++) {
        int terms = iso_chebyshev_exp(z[i], 1e-9, c);
        assert_true(terms > 1);
        for (int k = 0; k <= 100; k++) {
            double x = -1.0 + 0.02 * k, sum = 0.0;
            for (int j = terms - 1; j >= 0; j--) {
                sum += c[j] * cos(j * acos(x));
            }
            assert_true(fabs(sum - exp(-z[i] * (1.0 + x))) < 1.1e-9);
        }
        assert_true(iso_chebyshev_exp(z[i], 1e-4, c) < terms);
    }
    assert_int_equal(iso_chebyshev_exp(1e5, 1e-9, c), -ERANGE);
    assert_int_equal(iso_chebyshev_exp(0.0, 1e-9, c), -ERANGE);
    assert_int_equal(iso_chebyshev_exp(NAN, 1e-9, c), -ERANGE);
}

static void on_a_plane_heat_is_gaussian(void **state)
{
    (void)state;
    struct grid_surface s = grid_surface_hills(2.0, 0.0);
    struct iso_heat_grid *solver = new_solver(&s, 1, 1, 0);
    const double t_mm2 = 60.0, x_mm = 3.7, y_mm = -5.2;
    struct iso_grid_point source = grid_surface_point(&s, x_mm, y_mm);
    const struct iso_heat_grid_request request = {&source, 1, &t_mm2, 1, 20.0};
    assert_int_equal(iso_heat_grid(solver, s.grid, &request, NULL), 0);
    struct iso_grid_field column = iso_heat_grid_column(solver, 0, 0);
    double total = 0.0;
    for (int row = 0; row < s.grid->height; row++) {
        for (int i = row * s.grid->stride; i < row * s.grid->stride + s.grid->width; i++) {
            total += (double)(column.value[i] * s.grid->share_mm2[i]);
            struct iso_vec3 p = iso_grid_vertex(s.grid, i);
            double r = hypot(p.x - x_mm, p.y - y_mm);
            if (r < 22.0) {
                double exact = exp(-r * r / (4.0 * t_mm2)) / (4.0 * M_PI * t_mm2);
                /* What a mesh of 2 mm can say of a point source. */
                assert_true(fabs((double)column.value[i] / exact - 1.0) < 0.03);
            }
        }
    }
    assert_true(total < 1.0 && total > 0.97); /* the rest left over the window's cold border */
    iso_heat_grid_free(solver);
    grid_surface_done(&s);
}

enum { SOURCES = 5 };

static void make_sources(const struct grid_surface *s, struct iso_grid_point source[SOURCES])
{
    const double place_mm[SOURCES][2] = {
        {3.3, -4.1}, {-61.0, 40.2}, {30.0, 21.7}, {-20.5, -47.9}, {66.9, 13.3}};
    for (int i = 0; i < SOURCES; i++) {
        source[i] = grid_surface_point(s, place_mm[i][0], place_mm[i][1]);
    }
}

/* Largest difference of two columns in terms of the peak of the first. */
static double difference(const struct iso_grid *grid, struct iso_grid_field a,
                         struct iso_grid_field b)
{
    double most = 0.0, peak = 0.0;
    for (int i = 0; i < grid->height * grid->stride; i++) {
        peak = fmax(peak, (double)a.value[i]);
        most = fmax(most, fabs((double)a.value[i] - (double)b.value[i]));
    }
    assert_true(peak > 0.0);
    return most / peak;
}

static void several_times_in_one_pass_are_the_times_one_by_one(void **state)
{
    (void)state;
    struct grid_surface s = grid_surface_hills(2.0, 1.0);
    struct iso_grid_point source[SOURCES];
    make_sources(&s, source);
    const double t_mm2[] = {30.0, 100.0, 70.0};
    struct iso_heat_grid *several = new_solver(&s, SOURCES, 3, 0);
    struct iso_heat_grid *single = new_solver(&s, 1, 1, 0);
    const struct iso_heat_grid_request all = {source, SOURCES, t_mm2, 3, 90.0};
    assert_int_equal(iso_heat_grid(several, s.grid, &all, NULL), 0);
    for (int i = 0; i < SOURCES; i++) {
        for (int j = 0; j < 3; j++) {
            /* The radius is so large that no window ends where there is heat. */
            const struct iso_heat_grid_request one = {&source[i], 1, &t_mm2[j], 1, 90.0};
            assert_int_equal(iso_heat_grid(single, s.grid, &one, NULL), 0);
            assert_true(difference(s.grid, iso_heat_grid_column(several, i, j),
                                   iso_heat_grid_column(single, 0, 0)) < 1e-5);
        }
    }
    iso_heat_grid_free(several);
    iso_heat_grid_free(single);
    grid_surface_done(&s);
}

enum { OPERATOR_TASKS = ISO_GRID_STENCIL_STEPS * ISO_GRID_STENCIL_BANDS };

static void neither_history_nor_workers_change_a_column(void **state)
{
    (void)state;
    struct grid_surface s = grid_surface_hills(2.0, 1.0);
    struct iso_grid_point source[SOURCES];
    make_sources(&s, source);
    const double t_mm2[] = {100.0, 40.0};
    struct iso_heat_grid *fresh = new_solver(&s, SOURCES, 2, 1);
    struct iso_heat_grid *used = new_solver(&s, SOURCES, 2, 3);
    int n_run = 0;
    const struct iso_tasks tasks = tasks_backwards(&n_run);
    for (int n_times = 1; n_times <= 2; n_times++) {
        const struct iso_heat_grid_request request = {source, SOURCES, t_mm2, n_times, 18.0};
        const struct iso_heat_grid_request before = {&source[n_times], 2, &t_mm2[1], 1, 50.0};
        assert_int_equal(iso_heat_grid(fresh, s.grid, &request, NULL), 0);
        assert_int_equal(iso_heat_grid(used, s.grid, &before, &tasks), 0);
        assert_int_equal(iso_heat_grid(used, s.grid, &request, &tasks), 0);
        /* The operator's bands, twice; the heat of each source. */
        assert_int_equal(n_run, n_times * (2 * OPERATOR_TASKS + 2 + SOURCES));
        for (int i = 0; i < SOURCES * n_times; i++) {
            struct iso_grid_field a = iso_heat_grid_column(fresh, i / n_times, i % n_times);
            struct iso_grid_field b = iso_heat_grid_column(used, i / n_times, i % n_times);
            assert_memory_equal(&a.window, &b.window, sizeof a.window);
            assert_true(difference(s.grid, a, b) == 0.0);
        }
    }
    assert_int_equal(iso_heat_grid_effort(fresh).steps, iso_heat_grid_effort(used).steps);
    assert_true(iso_heat_grid_effort(fresh).pixels > 1e5);
    iso_heat_grid_free(fresh);
    iso_heat_grid_free(used);
    grid_surface_done(&s);
}

static void what_is_too_stiff_is_declined(void **state)
{
    (void)state;
    struct grid_surface s = grid_surface_hills(2.0, 1.0);
    struct iso_heat_grid *solver = new_solver(&s, 1, 1, 0);
    struct iso_grid_point source = grid_surface_point(&s, 3.3, -4.1);
    double t_mm2 = 100.0;
    const struct iso_heat_grid_request request = {&source, 1, &t_mm2, 1, 18.0};
    assert_int_equal(iso_heat_grid(solver, s.grid, &request, NULL), 0);
    double stiffness = iso_heat_grid_effort(solver).stiffness_max;
    assert_true(stiffness > 200.0 && stiffness < 1000.0);
    t_mm2 *= 0.9 * ISO_HEAT_GRID_STIFFNESS_MAX / stiffness;
    assert_int_equal(iso_heat_grid(solver, s.grid, &request, NULL), 0);
    t_mm2 *= 1.2;
    assert_int_equal(iso_heat_grid(solver, s.grid, &request, NULL), -ERANGE);
    t_mm2 = 1e-5; /* hardly any time: the expansion still is one */
    assert_int_equal(iso_heat_grid(solver, s.grid, &request, NULL), 0);
    iso_heat_grid_free(solver);
    grid_surface_done(&s);
}

static void bad_requests_are_refused(void **state)
{
    (void)state;
    struct grid_surface s = grid_surface_hills(2.0, 1.0);
    struct iso_heat_grid *solver = new_solver(&s, 1, 1, 0);
    struct iso_grid_point source = grid_surface_point(&s, 3.3, -4.1), off = source;
    struct iso_grid_point two[2] = {source, source};
    off.corner[1] = 35 * s.grid->stride + 58; /* in the hole */
    const double t[2] = {100.0, 100.0}, zero = 0.0, endless = INFINITY;
    const struct iso_heat_grid_request bad[] = {
        {&source, 0, t, 1, 18.0}, {two, 2, t, 1, 18.0},         {&source, 1, t, 0, 18.0},
        {&source, 1, t, 2, 18.0}, {&source, 1, &zero, 1, 18.0}, {&source, 1, &endless, 1, 18.0},
        {&source, 1, t, 1, 0.0},  {&source, 1, t, 1, NAN},      {&off, 1, t, 1, 18.0},
    };
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        assert_int_equal(iso_heat_grid(solver, s.grid, &bad[i], NULL), -EINVAL);
    }
    int n_run = 0;
    const struct iso_tasks crowd = tasks_backwards(&n_run);
    const struct iso_heat_grid_request good = {&source, 1, t, 1, 18.0};
    assert_int_equal(iso_heat_grid(solver, s.grid, &good, &crowd), -EINVAL);
    struct iso_grid *other = NULL;
    assert_int_equal(iso_grid_new(s.grid->width, s.grid->height + 1, &other), 0);
    assert_int_equal(iso_heat_grid(solver, other, &good, NULL), -EINVAL);
    assert_int_equal(n_run, 0);
    iso_grid_free(other);
    const struct iso_heat_grid_options options[] = {{0, 1, 0},  {65, 1, 0},
                                                    {1, 0, 0},  {1, ISO_HEAT_GRID_TIMES_MAX + 1, 0},
                                                    {1, 1, -1}, {1, 1, 65}};
    struct iso_heat_grid *none = NULL;
    for (size_t i = 0; i < sizeof options / sizeof options[0]; i++) {
        assert_int_equal(iso_heat_grid_new(s.grid, &options[i], &none), -EINVAL);
    }
    assert_null(none);
    iso_heat_grid_free(NULL);
    iso_heat_grid_free(solver);
    grid_surface_done(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_operator_is_that_of_the_mesh),
        cmocka_unit_test(the_bound_holds_and_is_close),
        cmocka_unit_test(bands_make_the_same_operator_in_any_order),
        cmocka_unit_test(a_sweep_is_its_steps_to_the_bit),
        cmocka_unit_test(the_expansion_is_the_exponential),
        cmocka_unit_test(on_a_plane_heat_is_gaussian),
        cmocka_unit_test(several_times_in_one_pass_are_the_times_one_by_one),
        cmocka_unit_test(neither_history_nor_workers_change_a_column),
        cmocka_unit_test(what_is_too_stiff_is_declined),
        cmocka_unit_test(bad_requests_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
