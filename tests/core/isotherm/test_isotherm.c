/* Traced curves of known functions on known surfaces. */
#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "isotherm/heat_kernel.h"
#include "isotherm/isotherm_curve.h"
#include "tests/core/surfaces/matrices.h"
#include "tests/core/surfaces/shapes.h"

static const struct iso_vec3 origin = {0, 0, 0};

/* A mesh with a function on it, ready to be traced. */
struct scene {
    struct iso_mesh *mesh;
    int32_t (*adjacent)[3];
    double *heat;
    struct iso_tracer *tracer;
};

static struct scene scene_of(struct iso_mesh *mesh)
{
    struct scene s = {.mesh = mesh};
    s.adjacent = calloc((size_t)mesh->n_triangles, sizeof *s.adjacent);
    s.heat = calloc((size_t)mesh->n_vertices, sizeof *s.heat);
    assert_true(s.adjacent && s.heat);
    assert_int_equal(iso_mesh_adjacency(mesh, s.adjacent), 0);
    assert_int_equal(iso_tracer_new(mesh->n_triangles, &s.tracer), 0);
    return s;
}

/* Makes a scene whose heat is a function of the place. */
static struct scene scene_with(struct iso_mesh *mesh, double (*heat)(double x, double y))
{
    struct scene s = scene_of(mesh);
    for (int32_t i = 0; i < mesh->n_vertices; i++) {
        s.heat[i] = heat(mesh->vertices_mm[i].x, mesh->vertices_mm[i].y);
    }
    return s;
}

static void scene_done(struct scene *s)
{
    iso_mesh_free(s->mesh);
    free(s->adjacent);
    free(s->heat);
    iso_tracer_free(s->tracer);
}

static int trace(struct scene *s, double level)
{
    return iso_tracer_run(s->tracer, s->mesh, (const int32_t(*)[3])s->adjacent, s->heat, level);
}

/* Returns the area that a curve surrounds counter-clockwise, seen from +z. */
static double signed_area(struct iso_curve curve)
{
    double area = 0.0;
    for (int32_t i = 0; i < curve.n; i++) {
        struct iso_vec3 a = curve.points_mm[i], b = curve.points_mm[(i + 1) % curve.n];
        area += 0.5 * (a.x * b.y - a.y * b.x);
    }
    return area;
}

static double cone(double x, double y)
{
    return 50.0 - hypot(x, y);
}

static double two_hills(double x, double y)
{
    return exp(-(pow(x - 12, 2) + y * y) / 40.0) +
           0.8 * exp(-(pow(x + 14, 2) + pow(y - 3, 2)) / 50.0);
}

static double crater(double x, double y)
{
    return exp(-pow(hypot(x, y) - 10.0, 2) / 12.0);
}

static double hill_on_the_border(double x, double y)
{
    return exp(-(pow(x - 20, 2) + y * y) / 60.0);
}

static double ridge(double x, double y)
{
    (void)y;
    return -fabs(x - 1.0);
}

static double square_hill(double x, double y)
{
    return 10.0 - fmax(fabs(x), fabs(y));
}

static double flat(double x, double y)
{
    (void)x;
    (void)y;
    return 0.25;
}

static void a_hill_has_one_loop_with_the_hot_side_left(void **state)
{
    (void)state;
    struct scene s = scene_with(shape_sheet(61, 51, 0.5), cone);
    assert_int_equal(trace(&s, 41.3), 1);
    struct iso_curve curve = iso_tracer_curve(s.tracer, 0);
    assert_true(curve.closed);
    assert_true(signed_area(curve) > 0.0);
    assert_true(fabs(signed_area(curve) / (M_PI * 8.7 * 8.7) - 1.0) < 0.005);
    for (int32_t i = 0; i < curve.n; i++) {
        assert_true(fabs(iso_norm(curve.points_mm[i]) - 8.7) < 0.02);
        /* The curve steps from triangle to triangle and never jumps. */
        struct iso_vec3 next = curve.points_mm[(i + 1) % curve.n];
        assert_true(iso_norm(iso_sub(next, curve.points_mm[i])) < 0.71);
    }
    assert_int_equal(iso_tracer_enclosing(s.tracer, iso_vec3(3, -5, 40)), 0);
    assert_int_equal(iso_tracer_enclosing(s.tracer, iso_vec3(9, 0, 0)), -ENOENT);
    assert_int_equal(trace(&s, 60.0), 0);
    assert_int_equal(iso_tracer_enclosing(s.tracer, origin), -ENOENT);
    scene_done(&s);
}

static void of_two_loops_the_one_about_the_landmark_is_chosen(void **state)
{
    (void)state;
    struct scene s = scene_with(shape_sheet(81, 41, 0.8), two_hills);
    assert_int_equal(trace(&s, 0.4), 2);
    int right = iso_tracer_enclosing(s.tracer, iso_vec3(12, 0, 0));
    int left = iso_tracer_enclosing(s.tracer, iso_vec3(-14, 3, 0));
    assert_true(right >= 0 && left >= 0 && right != left);
    assert_int_equal(iso_tracer_enclosing(s.tracer, origin), -ENOENT);
    /* exp(-r^2 / 40) = 0.4, 0.8 exp(-r^2 / 50) = 0.4 */
    double area_right = signed_area(iso_tracer_curve(s.tracer, right));
    double area_left = signed_area(iso_tracer_curve(s.tracer, left));
    assert_true(fabs(area_right / (M_PI * 40.0 * log(2.5)) - 1.0) < 0.02);
    assert_true(fabs(area_left / (M_PI * 50.0 * log(2.0)) - 1.0) < 0.02);
    scene_done(&s);
}

static void of_nested_loops_the_outer_one_is_chosen(void **state)
{
    (void)state;
    struct scene s = scene_with(shape_sheet(71, 65, 0.6), crater);
    assert_int_equal(trace(&s, 0.5), 2);
    int outer = iso_tracer_enclosing(s.tracer, iso_vec3(1, 2, 0));
    assert_true(outer >= 0);
    double half_width = sqrt(12.0 * log(2.0));
    double area = signed_area(iso_tracer_curve(s.tracer, outer));
    assert_true(fabs(sqrt(area / M_PI) - (10.0 + half_width)) < 0.1);
    /* The inner loop runs clockwise, because its hot side is on the left, too. */
    double inner = signed_area(iso_tracer_curve(s.tracer, 1 - outer));
    assert_true(inner < 0.0 && fabs(sqrt(-inner / M_PI) - (10.0 - half_width)) < 0.1);
    scene_done(&s);
}

static void a_curve_at_the_border_is_open(void **state)
{
    (void)state;
    struct scene s = scene_with(shape_sheet(41, 51, 1.0), hill_on_the_border);
    assert_int_equal(trace(&s, 0.3), 1);
    struct iso_curve curve = iso_tracer_curve(s.tracer, 0);
    assert_false(curve.closed);
    /* Both ends are on the border x = 20. The hot side is on the left, so that the curve runs from
     * above to below. */
    struct iso_vec3 first = curve.points_mm[0], last = curve.points_mm[curve.n - 1];
    assert_true(first.x == 20.0 && last.x == 20.0);
    assert_true(first.y > 8.0 && last.y < -8.0);
    assert_int_equal(iso_tracer_enclosing(s.tracer, iso_vec3(17, 1, 0)), 0);
    struct iso_isotherm sampled;
    assert_int_equal(iso_isotherm_sample_polar(curve, iso_vec3(17, 1, 0), 36, &sampled), 0);
    assert_false(sampled.closed);
    for (int i = 0; i < 36; i++) {
        double angle = 2.0 * M_PI * i / 36; /* from +y to -x */
        bool inland = angle > 0.5 && angle < M_PI - 0.5;
        bool seaward = angle > M_PI + 0.5 && angle < 2.0 * M_PI - 0.5;
        assert_true(!inland || sampled.weight[i] == 1.0f);
        assert_true(!seaward || sampled.weight[i] == 0.0f);
        if (sampled.weight[i] == 0.0f) {
            assert_true(iso_norm(sampled.points_mm[i]) == 0.0);
        }
    }
    scene_done(&s);
}

static void two_open_curves_run_along_a_ridge(void **state)
{
    (void)state;
    struct scene s = scene_with(shape_sheet(31, 21, 1.0), ridge);
    assert_int_equal(trace(&s, -3.25), 2);
    for (int c = 0; c < 2; c++) {
        struct iso_curve curve = iso_tracer_curve(s.tracer, c);
        assert_false(curve.closed);
        bool right = curve.points_mm[0].x > 1.0;
        for (int32_t i = 0; i < curve.n; i++) {
            assert_true(fabs(curve.points_mm[i].x - (right ? 4.25 : -2.25)) < 1e-12);
        }
        /* The hot side is on the left: the curve goes up on the right of the ridge and down on its
         * left. */
        double rise = curve.points_mm[curve.n - 1].y - curve.points_mm[0].y;
        assert_true(fabs(rise - (right ? 20.0 : -20.0)) < 1e-12);
    }
    scene_done(&s);
}

/* Heat and level are whole numbers, so that the curve goes through vertices and along edges. */
static void vertices_exactly_on_the_level_do_no_harm(void **state)
{
    (void)state;
    struct scene s = scene_with(shape_sheet(25, 23, 1.0), square_hill);
    assert_int_equal(trace(&s, 6.0), 1);
    struct iso_curve curve = iso_tracer_curve(s.tracer, 0);
    assert_true(curve.closed);
    assert_true(fabs(signed_area(curve) - 64.0) < 1.01); /* corners may be cut off */
    assert_int_equal(iso_tracer_enclosing(s.tracer, iso_vec3(0.3, 0.1, 0)), 0);
    assert_int_equal(trace(&s, 10.0), 1); /* the peak itself */
    curve = iso_tracer_curve(s.tracer, 0);
    assert_true(curve.closed && fabs(signed_area(curve)) < 1e-12);
    assert_int_equal(trace(&s, -100.0), 0);
    scene_done(&s);
    s = scene_with(shape_sheet(9, 8, 1.0),
                   flat); /* all of it is at the level, which counts as hot */
    assert_int_equal(trace(&s, 0.25), 0);
    scene_done(&s);
}

static void a_tracer_has_its_size(void **state)
{
    (void)state;
    struct iso_tracer *tracer = NULL;
    assert_int_equal(iso_tracer_new(0, &tracer), -EINVAL);
    assert_null(tracer);
    struct scene s = scene_with(shape_sheet(5, 4, 1.0), cone);
    assert_int_equal(iso_tracer_new(s.mesh->n_triangles - 1, &tracer), 0);
    assert_int_equal(iso_tracer_run(tracer, s.mesh, (const int32_t(*)[3])s.adjacent, s.heat, 49.0),
                     -ENOSPC);
    iso_tracer_free(tracer);
    iso_tracer_free(NULL);
    scene_done(&s);
}

/* Releases heat at `source` of a mesh, and traces the isotherm of a radius. */
static struct scene heated(struct iso_mesh *mesh, struct iso_surface_point source, double radius_mm)
{
    const double t_mm2 = 100.0;
    struct scene s = scene_of(mesh);
    struct matrices m = matrices_of(mesh, ISO_MASS_CONSISTENT);
    const struct iso_heat_direct_options options = {.n_capacity = m.mass->n,
                                                    .nnz_capacity = m.mass->nnz};
    struct iso_heat_direct *solver = NULL;
    assert_int_equal(iso_heat_direct_new(&options, &solver), 0);
    assert_int_equal(
        iso_heat_direct(solver, mesh, m.stiffness, m.mass, &source, 1, &t_mm2, 1, s.heat), 0);
    double level;
    assert_int_equal(iso_isotherm_level(mesh, s.heat, radius_mm, &level), 0);
    assert_int_equal(trace(&s, level), 1);
    iso_heat_direct_free(solver);
    matrices_free(&m);
    return s;
}

/* The pitch is 2 mm, as on a face patch, and the source is not a vertex. */
static void an_isotherm_of_a_plane_is_a_circle(void **state)
{
    (void)state;
    const double radii[] = {10.0, 18.0, 30.0};
    for (size_t r = 0; r < sizeof radii / sizeof radii[0]; r++) {
        struct iso_mesh *sheet = shape_sheet(71, 75, 2.0);
        struct iso_surface_point source = shape_locate(sheet, 2.7, -1.9);
        struct scene s = heated(sheet, source, radii[r]);
        struct iso_isotherm sampled;
        const struct iso_vec3 centre = {2.7, -1.9, 0};
        assert_int_equal(
            iso_isotherm_sample_polar(iso_tracer_curve(s.tracer, 0), centre, 64, &sampled), 0);
        double worst = 0.0;
        for (int i = 0; i < 64; i++) {
            double reach = iso_norm(iso_sub(sampled.points_mm[i], centre));
            worst = fmax(worst, fabs(reach - radii[r]));
        }
        print_message("isotherm of a plane, r = %g: within %.3f mm of the circle\n", radii[r],
                      worst);
        assert_true(worst < 0.1);
        scene_done(&s);
    }
}

/* On a cylinder that is unrolled, the isotherm is in the same place as on the sheet. */
static void bending_leaves_the_isotherm_where_it_was(void **state)
{
    (void)state;
    const double radius = 18.0, bend = 45.0;
    struct iso_mesh *sheet = shape_sheet(65, 61, 2.0);
    struct iso_surface_point source = shape_locate(sheet, 4.4, 2.3);
    shape_roll(sheet, bend);
    struct scene s = heated(sheet, source, radius);
    struct iso_curve curve = iso_tracer_curve(s.tracer, 0);
    double mean = 0.0, worst = 0.0;
    for (int32_t i = 0; i < curve.n; i++) {
        struct iso_vec3 p = curve.points_mm[i];
        double unrolled = bend * atan2(p.x, p.z + bend);
        double reach = hypot(unrolled - 4.4, p.y - 2.3);
        mean += reach / curve.n;
        worst = fmax(worst, fabs(reach - radius));
    }
    print_message("isotherm on a cylinder: mean radius %.3f mm, worst %.3f mm off\n", mean, worst);
    assert_true(fabs(mean - radius) < 0.03);
    assert_true(worst < 0.12);
    scene_done(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_hill_has_one_loop_with_the_hot_side_left),
        cmocka_unit_test(of_two_loops_the_one_about_the_landmark_is_chosen),
        cmocka_unit_test(of_nested_loops_the_outer_one_is_chosen),
        cmocka_unit_test(a_curve_at_the_border_is_open),
        cmocka_unit_test(two_open_curves_run_along_a_ridge),
        cmocka_unit_test(vertices_exactly_on_the_level_do_no_harm),
        cmocka_unit_test(a_tracer_has_its_size),
        cmocka_unit_test(an_isotherm_of_a_plane_is_a_circle),
        cmocka_unit_test(bending_leaves_the_isotherm_where_it_was),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
