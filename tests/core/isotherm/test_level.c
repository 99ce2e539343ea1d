/* Areas and levels of known functions on a sheet. */
#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "isotherm/isotherm_curve.h"
#include "tests/core/surfaces/shapes.h"

/* A sheet with a function on it. */
struct scene {
    struct iso_mesh *mesh;
    double *heat;
};

static struct scene scene_with(struct iso_mesh *mesh, double (*heat)(double x, double y))
{
    struct scene s = {mesh, calloc((size_t)mesh->n_vertices, sizeof *s.heat)};
    assert_non_null(s.heat);
    for (int32_t i = 0; i < mesh->n_vertices; i++) {
        s.heat[i] = heat(mesh->vertices_mm[i].x, mesh->vertices_mm[i].y);
    }
    return s;
}

static void scene_done(struct scene *s)
{
    iso_mesh_free(s->mesh);
    free(s->heat);
}

static double ramp(double x, double y)
{
    return 2.0 * x + 0.5 * y + 3.0;
}

static double cone(double x, double y)
{
    return 50.0 - hypot(x, y);
}

/* Falls by twelve orders of magnitude within 16.6 mm. */
static double steep_hill(double x, double y)
{
    return 3e-4 * exp(-(x * x + y * y) / 10.0);
}

static double flat(double x, double y)
{
    (void)x;
    (void)y;
    return 0.25;
}

static double cold(double x, double y)
{
    (void)x;
    (void)y;
    return 0.0;
}

/* 20 x 12 mm; {2 x + y / 2 + 3 >= level} is a trapezium. */
static void areas_above_a_ramp_are_exact(void **state)
{
    (void)state;
    struct scene s = scene_with(shape_sheet(21, 13, 1.0), ramp);
    const double levels[] = {-9.3, 0.0, 3.0, 7.77};
    for (size_t i = 0; i < sizeof levels / sizeof levels[0]; i++) {
        double x = (levels[i] - 3.0) / 2.0; /* where the level crosses y = 0 */
        double exact = 12.0 * (10.0 - x);
        assert_true(fabs(iso_isotherm_area_above(s.mesh, s.heat, levels[i]) - exact) < 1e-9);
    }
    assert_true(fabs(iso_isotherm_area_above(s.mesh, s.heat, -100.0) - 240.0) < 1e-9);
    assert_true(iso_isotherm_area_above(s.mesh, s.heat, 100.0) == 0.0);
    scene_done(&s);
}

static void the_level_encloses_the_area_of_the_circle(void **state)
{
    (void)state;
    struct scene s = scene_with(shape_sheet(81, 71, 0.5), cone);
    const double radii[] = {3.0, 8.5, 15.0};
    for (size_t i = 0; i < sizeof radii / sizeof radii[0]; i++) {
        double level = NAN, wanted = M_PI * radii[i] * radii[i];
        assert_int_equal(iso_isotherm_level(s.mesh, s.heat, radii[i], &level), 0);
        assert_true(fabs(level - (50.0 - radii[i])) < 0.02);
        double area = iso_isotherm_area_above(s.mesh, s.heat, level);
        assert_true(fabs(area / wanted - 1.0) < 2e-6);
    }
    scene_done(&s);
}

/* Regula falsi begins between two levels, and the hotter ones are no longer looked at: whichever
 * levels these are, the area is the wanted one of the whole mesh. */
static void levels_far_below_the_highest_are_found(void **state)
{
    (void)state;
    struct scene s = scene_with(shape_sheet(81, 71, 0.5), steep_hill);
    const double radii[] = {1.0, 3.5, 3.9, 5.2, 7.4, 7.6, 10.4, 10.6, 14.0, 16.0};
    for (size_t i = 0; i < sizeof radii / sizeof radii[0]; i++) {
        double level = NAN, wanted = M_PI * radii[i] * radii[i];
        assert_int_equal(iso_isotherm_level(s.mesh, s.heat, radii[i], &level), 0);
        assert_true(fabs(log(level / steep_hill(radii[i], 0.0))) < 0.7); /* linear in a triangle */
        assert_true(fabs(iso_isotherm_area_above(s.mesh, s.heat, level) / wanted - 1.0) < 2e-6);
    }
    double level = -7.0;
    assert_int_equal(iso_isotherm_level(s.mesh, s.heat, 17.4, &level), -ERANGE);
    assert_true(level == -7.0);
    scene_done(&s);
}

static void no_level_encloses_more_than_there_is(void **state)
{
    (void)state;
    double level = -7.0;
    struct scene s = scene_with(shape_sheet(21, 13, 1.0), cone);
    assert_int_equal(iso_isotherm_level(s.mesh, s.heat, 8.8, &level), -ERANGE);
    assert_int_equal(iso_isotherm_level(s.mesh, s.heat, 8.7, &level), 0);
    scene_done(&s);
    level = -7.0;
    s = scene_with(shape_sheet(21, 13, 1.0), flat);
    assert_int_equal(iso_isotherm_level(s.mesh, s.heat, 3.0, &level), -ERANGE);
    scene_done(&s);
    s = scene_with(shape_sheet(21, 13, 1.0), cold);
    assert_int_equal(iso_isotherm_level(s.mesh, s.heat, 3.0, &level), -ERANGE);
    scene_done(&s);
    assert_true(level == -7.0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(areas_above_a_ramp_are_exact),
        cmocka_unit_test(the_level_encloses_the_area_of_the_circle),
        cmocka_unit_test(levels_far_below_the_highest_are_found),
        cmocka_unit_test(no_level_encloses_more_than_there_is),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
