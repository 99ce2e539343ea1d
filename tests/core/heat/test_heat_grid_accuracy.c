/* The distance between the isotherms of the grid heat solver and those of a reference with eleven
 * correct digits, on the mean face: with the same lumped mass, and with the consistent mass that
 * the general solver uses. The test asserts the limits that the product promises, and prints the
 * other figures. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "core/heat/grid/heat_grid.h"
#include "core/isotherm/grid_isotherm.h"
#include "tests/core/surfaces/grid_surface.h"
#include "tests/core/surfaces/matrices.h"
#include "tests/core/surfaces/reference_heat.h"

enum { SOURCES = 3, TIMES = 4, RADII = 4, POINTS = 64 };

static const double t_mm2[TIMES] = {50, 75, 100, 200};
static const double radius_mm[RADII] = {10, 18, 30, 40};

/* Places near the nose tip, the inner eye corner and the mouth corner. */
static const double place_mm[SOURCES][2] = {{0.3, 0.4}, {17.3, 33.1}, {-24.4, -33.7}};

/* Sum of squares and count of distances between isotherms. */
struct error {
    double square;
    int points;
};

static bool on_mesh(const struct grid_surface *s, struct iso_tracer *tracer, const double *heat,
                    struct iso_vec3 centre, double radius, struct iso_isotherm *out)
{
    double level;
    if (iso_isotherm_level(s->mesh, heat, radius, &level)) {
        return false;
    }
    assert_true(iso_tracer_run(tracer, s->mesh, (const int32_t(*)[3])s->adjacent, heat, level) > 0);
    int curve = iso_tracer_enclosing(tracer, centre);
    assert_true(curve >= 0);
    assert_int_equal(
        iso_isotherm_sample_polar(iso_tracer_curve(tracer, curve), centre, POINTS, out), 0);
    return true;
}

static void on_grid(const struct grid_surface *s, struct iso_grid_tracer *tracer,
                    struct iso_grid_field field, struct iso_vec3 centre, double radius,
                    struct iso_isotherm *out)
{
    double level;
    iso_grid_tracer_begin(tracer, s->grid, &field);
    assert_true(iso_grid_tracer_run(tracer, radius, &level) > 0);
    const struct iso_tracer *curves = iso_grid_tracer_curves(tracer);
    int curve = iso_tracer_enclosing(curves, centre);
    assert_true(curve >= 0);
    assert_int_equal(
        iso_isotherm_sample_polar(iso_tracer_curve(curves, curve), centre, POINTS, out), 0);
}

static void add(struct error *error, const struct iso_isotherm *exact,
                const struct iso_isotherm *found)
{
    for (int i = 0; i < POINTS; i++) {
        if (exact->weight[i] == 0.0f) { /* the surface ends inside the isotherm */
            continue;
        }
        assert_true(found->weight[i] > 0.0f);
        struct iso_vec3 off = iso_sub(exact->points_mm[i], found->points_mm[i]);
        error->square += iso_dot(off, off);
        error->points++;
    }
}

/* Adds the errors of the isotherms of one source. */
static void compare_source(const struct grid_surface *s, enum iso_mass mass, int source,
                           struct iso_heat_grid *solver, struct error error[TIMES][RADII])
{
    const double *place = place_mm[source];
    struct iso_surface_point at = grid_surface_mesh_point(s, place[0], place[1]);
    struct iso_vec3 centre = iso_mesh_point_at(s->mesh, at);
    size_t n = (size_t)s->mesh->n_vertices;
    double *exact = calloc(TIMES * n, sizeof *exact);
    assert_non_null(exact);
    struct matrices m = matrices_of(s->mesh, mass);
    reference_heat(s->mesh, &m, at, t_mm2, TIMES, exact);
    matrices_free(&m);
    struct iso_tracer *mesh_tracer = NULL;
    struct iso_grid_tracer *grid_tracer = NULL;
    assert_int_equal(iso_tracer_new(s->mesh->n_triangles, &mesh_tracer), 0);
    assert_int_equal(iso_grid_tracer_new(s->grid, &grid_tracer), 0);
    struct iso_grid_point point = grid_surface_point(s, place[0], place[1]);
    for (int j = 0; j < TIMES; j++) {
        for (int r = 0; r < RADII; r++) {
            const struct iso_heat_grid_request request = {
                .sources = &point,
                .n_sources = 1,
                .t_mm2 = t_mm2[j],
                .radius_mm = radius_mm[r],
            };
            struct iso_isotherm a, b;
            assert_int_equal(iso_heat_grid(solver, s->grid, &request), 0);
            assert_true(on_mesh(s, mesh_tracer, &exact[(size_t)j * n], centre, radius_mm[r], &a));
            on_grid(s, grid_tracer, iso_heat_grid_column(solver, 0), centre, radius_mm[r], &b);
            add(&error[j][r], &a, &b);
        }
    }
    iso_tracer_free(mesh_tracer);
    iso_grid_tracer_free(grid_tracer);
    free(exact);
}

/* Fails where an error exceeds the limit of its time and radius. */
static void compare(enum iso_mass mass, const char *name, const double limit_mm[TIMES][RADII])
{
    struct grid_surface s = grid_surface_mean_face(2.0);
    struct error error[TIMES][RADII] = {0};
    struct iso_heat_grid *solver = NULL;
    assert_int_equal(iso_heat_grid_new(s.grid, 1, &solver), 0);
    for (int source = 0; source < SOURCES; source++) {
        compare_source(&s, mass, source, solver, error);
    }
    iso_heat_grid_free(solver);
    for (int j = 0; j < TIMES; j++) {
        for (int r = 0; r < RADII; r++) {
            double rms = sqrt(error[j][r].square / error[j][r].points);
            print_message("%s, t = %3g mm^2, r = %2g mm: rms %.4f mm of %d points\n", name,
                          t_mm2[j], radius_mm[r], rms, error[j][r].points);
            assert_true(error[j][r].points > SOURCES * POINTS * 8 / 10);
            assert_true(rms < limit_mm[j][r]);
        }
    }
    grid_surface_done(&s);
}

static void isotherms_are_those_of_the_lumped_mass(void **state)
{
    (void)state;
    static const double promised_mm[TIMES][RADII] = {
        {0.05, 0.05, 0.05, 0.05},
        {0.05, 0.05, 0.05, 0.05},
        {0.05, 0.05, 0.05, 0.05},
        {0.05, 0.05, 0.05, 0.05},
    };
    compare(ISO_MASS_LUMPED, "lumped", promised_mm);
}

static void isotherms_are_those_of_the_consistent_mass(void **state)
{
    (void)state;
    /* The error of a mesh of 2 mm, where the heat is large enough to measure. The error grows with
     * the radius and falls with the time. */
    static const double open_mm[TIMES][RADII] = {
        {0.3, 0.3, INFINITY, INFINITY},
        {0.3, 0.3, 0.6, INFINITY},
        {0.3, 0.15, 0.3, 1.0},
        {0.3, 0.15, 0.15, 0.15},
    };
    compare(ISO_MASS_CONSISTENT, "consistent", open_mm);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(isotherms_are_those_of_the_lumped_mass),
        cmocka_unit_test(isotherms_are_those_of_the_consistent_mass),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
