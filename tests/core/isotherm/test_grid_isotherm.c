/* Isotherms that are traced on a grid equal those that are traced on the mesh of the same frame. */
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

#include "core/isotherm/grid_isotherm.h"
#include "tests/core/surfaces/grid_surface.h"

struct fixture {
    struct grid_surface surface;
    struct iso_grid_tracer *on_grid;
    struct iso_tracer *on_mesh;
    float *plane; /* with its margins */
    struct iso_grid_field field;
};

static void *fixture_of(struct grid_surface surface)
{
    struct fixture *f = calloc(1, sizeof *f);
    assert_non_null(f);
    f->surface = surface;
    const struct iso_grid *grid = surface.grid;
    assert_int_equal(iso_grid_tracer_new(grid, &f->on_grid), 0);
    assert_int_equal(iso_tracer_new(surface.mesh->n_triangles, &f->on_mesh), 0);
    f->plane = calloc(iso_grid_plane_size(grid), sizeof *f->plane);
    assert_non_null(f->plane);
    f->field.value = f->plane + iso_grid_plane_origin(grid);
    f->field.window = (struct iso_grid_window){0, 0, grid->width, grid->height};
    return f;
}

static int set_up_hills(void **state)
{
    *state = fixture_of(grid_surface_hills(2.0, 1.0));
    return 0;
}

static int set_up_plane(void **state)
{
    *state = fixture_of(grid_surface_hills(2.0, 0.0));
    return 0;
}

static int tear_down(void **state)
{
    struct fixture *f = *state;
    grid_surface_done(&f->surface);
    iso_grid_tracer_free(f->on_grid);
    iso_tracer_free(f->on_mesh);
    free(f->plane);
    free(f);
    return 0;
}

/* Fills the field with a function similar to heat about (x_mm, y_mm). With `bumps` a level has
 * several loops. */
static void heat_up(struct fixture *f, double x_mm, double y_mm, double t_mm2, double bumps)
{
    float *value = f->plane + iso_grid_plane_origin(f->surface.grid);
    for (int32_t i = 0; i < f->surface.mesh->n_vertices; i++) {
        struct iso_vec3 p = f->surface.mesh->vertices_mm[i];
        double square = (p.x - x_mm) * (p.x - x_mm) + (p.y - y_mm) * (p.y - y_mm);
        double bump = exp(bumps * sin(0.5 * p.x) * sin(0.4 * p.y + 0.1 * p.x));
        value[f->surface.plane_index[i]] = (float)(exp(-square / (4.0 * t_mm2)) * bump);
    }
}

static int run(struct fixture *f, double radius_mm, double *level)
{
    iso_grid_tracer_begin(f->on_grid, f->surface.grid, &f->field);
    return iso_grid_tracer_run(f->on_grid, radius_mm, level);
}

static void assert_same_curves(struct fixture *f, double radius_mm, int *n_curves, int *n_open)
{
    const struct grid_surface *s = &f->surface;
    double *heat = grid_surface_on_mesh(s, &f->field), level = 0.0, mesh_level = 0.0;
    int n = run(f, radius_mm, &level);
    assert_int_equal(iso_isotherm_level(s->mesh, heat, radius_mm, &mesh_level), 0);
    assert_true(fabs(level / mesh_level - 1.0) < 1e-5);
    /* Both use exactly the same level, so that rounding makes no difference between the curves. */
    assert_int_equal(
        iso_tracer_run(f->on_mesh, s->mesh, (const int32_t(*)[3])s->adjacent, heat, level), n);
    for (int i = 0; i < n; i++) {
        struct iso_curve a = iso_tracer_curve(iso_grid_tracer_curves(f->on_grid), i);
        struct iso_curve b = iso_tracer_curve(f->on_mesh, i);
        assert_int_equal(a.n, b.n);
        assert_int_equal(a.closed, b.closed);
        *n_open += !a.closed;
        for (int32_t k = 0; k < a.n; k++) {
            assert_true(iso_norm(iso_sub(a.points_mm[k], b.points_mm[k])) < 1e-9);
        }
    }
    *n_curves += n;
    free(heat);
}

static void curves_are_those_of_the_mesh(void **state)
{
    struct fixture *f = *state;
    int n_curves = 0, n_open = 0;
    for (int i = 0; i < 24; i++) {
        heat_up(f, 11.0 * (i % 6) - 27.0, 9.0 * (i / 6) - 13.0, 40.0 + 30.0 * (i % 5),
                i % 3 == 2 ? 2.0 : 0.05 * i);
        assert_same_curves(f, 8.0 + 1.3 * i, &n_curves, &n_open);
    }
    print_message("%d curves, %d of them open\n", n_curves, n_open);
    assert_true(n_curves > 100 && n_open > 20 && n_open < n_curves);
}

static void on_a_plane_they_enclose_the_circle(void **state)
{
    struct fixture *f = *state;
    heat_up(f, 3.3, -4.1, 100.0, 0.0);
    double level = 0.0;
    assert_int_equal(run(f, 20.0, &level), 1);
    assert_true(fabs(level / exp(-400.0 / 400.0) - 1.0) < 0.01);
    struct iso_curve curve = iso_tracer_curve(iso_grid_tracer_curves(f->on_grid), 0);
    assert_true(curve.closed);
    for (int32_t i = 0; i < curve.n; i++) {
        struct iso_vec3 p = curve.points_mm[i];
        assert_true(fabs(hypot(p.x - 3.3, p.y + 4.1) - 20.0) < 0.1);
    }
}

static void a_window_is_a_border(void **state)
{
    struct fixture *f = *state;
    heat_up(f, 0.0, 0.0, 100.0, 0.0);
    /* The window is 40 mm wide and 100 mm high, so that a circle of 24 mm is cut on both sides. */
    const struct iso_grid_window narrow = {27, 3, 21, 51};
    f->field.window = narrow;
    double level = 0.0;
    assert_int_equal(run(f, 24.0, &level), 2);
    for (int i = 0; i < 2; i++) {
        struct iso_curve curve = iso_tracer_curve(iso_grid_tracer_curves(f->on_grid), i);
        assert_false(curve.closed);
        assert_true(fabs(fabs(curve.points_mm[0].x) - 20.0) < 1e-9);
        assert_true(fabs(fabs(curve.points_mm[curve.n - 1].x) - 20.0) < 1e-9);
    }
    assert_int_equal(run(f, 40.0, &level), -ERANGE);
}

static void a_field_without_heat_or_room_is_refused(void **state)
{
    struct fixture *f = *state;
    double level = 7.0;
    assert_int_equal(run(f, 10.0, &level), -ERANGE);
    heat_up(f, 0.0, 0.0, 100.0, 0.0);
    assert_int_equal(run(f, 80.0, &level), -ERANGE);
    assert_true(level == 7.0);
    assert_true(run(f, 70.0, &level) > 0);
    iso_grid_tracer_free(NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(curves_are_those_of_the_mesh, set_up_hills, tear_down),
        cmocka_unit_test_setup_teardown(on_a_plane_they_enclose_the_circle, set_up_plane,
                                        tear_down),
        cmocka_unit_test_setup_teardown(a_window_is_a_border, set_up_plane, tear_down),
        cmocka_unit_test_setup_teardown(a_field_without_heat_or_room_is_refused, set_up_plane,
                                        tear_down),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
