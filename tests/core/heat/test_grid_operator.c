/* The heat operator on a depth grid. It equals that of the mesh, its bound holds, earlier builds do
 * not change it, and a sweep of several steps equals the single steps bit by bit. */
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
#include "core/heat/grid/grid_step.h"
#include "tests/core/surfaces/grid_surface.h"
#include "tests/core/surfaces/matrices.h"

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

/* Returns the window of the whole grid, whose width is rounded up to complete groups of lanes. */
static struct iso_grid_window everything(const struct iso_grid *grid)
{
    return (struct iso_grid_window){0, 0, (grid->width + ISO_LANES - 1) / ISO_LANES * ISO_LANES,
                                    grid->height};
}

/* Pseudo-random values at the vertices. */
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

/* The windows begin at the first ten rows and have every height below 60. */
static void an_operator_does_not_depend_on_earlier_windows(void **state)
{
    (void)state;
    enum { PLANES = 7 };
    struct grid_surface s = grid_surface_hills(2.0, 1.0);
    struct iso_grid_stencil *used = NULL, *fresh = NULL;
    assert_int_equal(iso_grid_stencil_new(s.grid, &used), 0);
    for (int row = 0; row < 10; row++) {
        for (int height = 1; row + height <= s.grid->height && height < 60; height++) {
            const struct iso_grid_window window = {ISO_LANES, row, 2 * ISO_LANES, height};
            iso_grid_stencil_build(used, s.grid, window);
            assert_true(iso_grid_stencil_bound(used, window) > 0.0);
            assert_int_equal(iso_grid_stencil_new(s.grid, &fresh), 0);
            iso_grid_stencil_build(fresh, s.grid, window);
            assert_memory_equal(used->memory, fresh->memory,
                                PLANES * used->plane_size * sizeof(float));
            iso_grid_stencil_free(fresh);
        }
    }
    iso_grid_stencil_free(used);
    grid_surface_done(&s);
}

/* The last two vectors of a recurrence. */
struct vectors {
    float *plane[2];
};

static struct vectors any_vectors(const struct grid_surface *s)
{
    return (struct vectors){{any_values(s), new_plane(s->grid)}};
}

/* Describes steps with loads. Their windows grow, and begin at odd and even rows. */
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
        };
    }
}

static void assert_same_vectors(const struct iso_grid *grid, const struct vectors *a,
                                const struct vectors *b)
{
    for (int k = 0; k < 2; k++) {
        assert_true(norm(grid, a->plane[k]) > 1.0);
        assert_memory_equal(a->plane[k], b->plane[k],
                            (size_t)(grid->height * grid->stride) * sizeof(float));
    }
}

static void free_vectors(const struct iso_grid *grid, const struct vectors *v)
{
    for (int k = 0; k < 2; k++) {
        free_plane(grid, v->plane[k]);
    }
}

/* The result is the same for every number of steps in a pass, in every implementation. */
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

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_operator_is_that_of_the_mesh),
        cmocka_unit_test(the_bound_holds_and_is_close),
        cmocka_unit_test(an_operator_does_not_depend_on_earlier_windows),
        cmocka_unit_test(a_sweep_is_its_steps_to_the_bit),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
