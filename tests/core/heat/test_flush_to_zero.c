/* Numbers below the normal range count as 0 while heat is computed on a grid: without that there
 * are some, no number that matters changes, and the thread computes with them again afterwards. */
#include <float.h>
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
#include "core/heat/grid/flush_to_zero.h"
#include "core/heat/grid/grid_step.h"
#include "core/heat/grid/heat_grid.h"
#include "tests/core/surfaces/grid_surface.h"

enum { STEPS = 120 };

#ifdef __SSE2__
static const bool flushes = true;
#else
static const bool flushes = false;
#endif

struct recurrence {
    struct iso_grid_window window;
    size_t n;
    float *plane[2]; /* its last two vectors; [0] is the last one */
};

static struct recurrence new_recurrence(const struct iso_grid *grid)
{
    struct recurrence r = {.n = iso_grid_plane_size(grid)};
    r.window = (struct iso_grid_window){0, 0, (grid->width + ISO_LANES - 1) / ISO_LANES * ISO_LANES,
                                        grid->height};
    for (int i = 0; i < 2; i++) {
        r.plane[i] = calloc(r.n, sizeof(float));
        assert_non_null(r.plane[i]);
    }
    return r;
}

static void free_recurrence(struct recurrence *r)
{
    free(r->plane[0]);
    free(r->plane[1]);
}

/* Chebyshev's recurrence from a load of 1 at a vertex in the middle. */
static struct recurrence run(const struct grid_surface *s, const struct iso_grid_stencil *stencil)
{
    struct recurrence r = new_recurrence(s->grid);
    const size_t origin = iso_grid_plane_origin(s->grid);
    const double lambda = iso_grid_stencil_bound(stencil, r.window);
    r.plane[0][origin + (size_t)s->plane_index[s->mesh->n_vertices / 2]] = 1e-9f;
    for (int i = 0; i < STEPS; i++) {
        const struct iso_grid_step step = {.window = r.window,
                                           .forth = (float)(4.0 / lambda),
                                           .back = -2.0f,
                                           .y = r.plane[0] + origin,
                                           .io = r.plane[1] + origin};
        iso_grid_stepper().sweep(stencil, &step, 1);
        float *last = r.plane[1];
        r.plane[1] = r.plane[0];
        r.plane[0] = last;
    }
    return r;
}

static int count_below_normal(const float *plane, size_t n)
{
    int found = 0;
    for (size_t i = 0; i < n; i++) {
        uint32_t bits; /* a comparison would depend on what is tested here */
        memcpy(&bits, &plane[i], sizeof bits);
        found += (bits & 0x7f800000u) == 0 && (bits & 0x007fffffu) != 0;
    }
    return found;
}

static double largest(const float *plane, size_t n)
{
    double most = 0.0;
    for (size_t i = 0; i < n; i++) {
        most = fmax(most, fabs((double)plane[i]));
    }
    return most;
}

/* Steps carry the change on into larger numbers. It is of the size of what
 * the steps round off. */
static void the_change_is_of_the_size_of_rounding(void **state)
{
    (void)state;
    struct grid_surface s = grid_surface_mean_face(0.8);
    struct iso_grid_stencil *stencil = NULL;
    assert_int_equal(iso_grid_stencil_new(s.grid, &stencil), 0);
    struct recurrence empty = new_recurrence(s.grid);
    iso_grid_stencil_build(stencil, s.grid, empty.window);
    struct recurrence plain = run(&s, stencil);
    const unsigned before = iso_flush_to_zero_begin();
    struct recurrence flushed = run(&s, stencil);
    iso_flush_to_zero_end(before);

    assert_true(count_below_normal(plain.plane[0], plain.n) > 0);
    if (flushes) {
        assert_int_equal(count_below_normal(flushed.plane[0], flushed.n), 0);
    }
    double change = 0.0;
    for (size_t i = 0; i < plain.n; i++) {
        change = fmax(change, fabs((double)plain.plane[0][i] - (double)flushed.plane[0][i]));
    }
    const double most = largest(plain.plane[0], plain.n);
    print_message("largest number %.3g, largest change %.3g\n", most, change);
    assert_true(most > 1e-12 && change < 1e-6 * most);
    free_recurrence(&empty);
    free_recurrence(&plain);
    free_recurrence(&flushed);
    iso_grid_stencil_free(stencil);
    grid_surface_done(&s);
}

/* iso_heat_grid flushes what it computes, and not what the thread computes afterwards. */
static void heat_has_no_such_numbers_and_its_caller_has(void **state)
{
    (void)state;
    struct grid_surface s = grid_surface_mean_face(0.8);
    struct iso_heat_grid *heat = NULL;
    const struct iso_grid_point source = grid_surface_point(&s, 0.0, 0.0);
    const struct iso_heat_grid_request request = {
        .sources = &source, .n_sources = 1, .t_mm2 = 20.0, .radius_mm = 40.0};
    assert_int_equal(iso_heat_grid_new(s.grid, 1, &heat), 0);
    assert_int_equal(iso_heat_grid(heat, s.grid, &request), 0);
    const struct iso_grid_field field = iso_heat_grid_column(heat, 0);
    int found = 0;
    for (int row = field.window.row; row < field.window.row + field.window.height; row++) {
        found += count_below_normal(&field.value[row * s.grid->stride + field.window.column],
                                    (size_t)field.window.width);
    }
    if (flushes) {
        assert_int_equal(found, 0);
    }
    const volatile float small = FLT_MIN;
    const volatile float smaller = small / 4.0f;
    assert_int_equal(count_below_normal((const float *)&smaller, 1), 1);
    iso_heat_grid_free(heat);
    grid_surface_done(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_change_is_of_the_size_of_rounding),
        cmocka_unit_test(heat_has_no_such_numbers_and_its_caller_has),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
