/* The properties of single methods on faces with known shape: ICP, weighted contours, geodesics. */
#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "sim/base/random.h"
#include "sim/lab/methods/geodesic.h"
#include "sim/lab/methods/method.h"
#include "tests/sim/lab/drawn_face.h"

static double icp_between(const struct sim_method *icp, const struct sim_scan *a,
                          const struct sim_scan *b)
{
    void *probe = described(icp, NULL, a), *gallery = described(icp, NULL, b);
    double d = method_distance(icp, NULL, probe, gallery);
    icp->discard(probe);
    icp->discard(gallery);
    return d;
}

/* The same person with the head turned a little. The remaining distance comes from the change of
 * shape by the turn. It is far below that of another person. */
static void test_icp_moves_faces(void **state)
{
    (void)state;
    struct drawn_person straight = {3, 0.0, 0.0, NULL}, turned = {3, 0.0, 0.06, NULL},
                        other = {4, 0.0, 0.0, NULL};
    struct sim_scan *a = drawn_surface(drawn_relief, &straight),
                    *b = drawn_surface(drawn_relief, &turned),
                    *c = drawn_surface(drawn_relief, &other);
    double same = icp_between(&sim_method_icp, a, a);
    double moved = icp_between(&sim_method_icp, a, b), else_where = 0.0;
    for (size_t i = 0; i < sim_scan_pixels(a); i++) {
        double d = (double)(a->z_mm[i] - b->z_mm[i]);
        else_where = isnan(d) ? else_where : fmax(else_where, fabs(d));
    }
    assert_true(same < 1e-4);
    assert_true(else_where > 4.0); /* before they are registered */
    assert_true(moved < 0.2);
    assert_true(icp_between(&sim_method_icp, a, c) > 2.0 * moved);
    sim_scan_free(a);
    sim_scan_free(b);
    sim_scan_free(c);
}

/* A change below the nose does not affect the ICP of the upper face. */
static void test_icp_upper_looks_above(void **state)
{
    (void)state;
    struct sim_scan *a = drawn_face(5, 0.0, 0), *b = drawn_face(5, 0.0, 0);
    for (int row = DRAWN_SIDE / 2 + 8; row < DRAWN_SIDE; row++) {
        for (int column = 0; column < DRAWN_SIDE; column++) {
            b->z_mm[row * DRAWN_SIDE + column] += (float)(3.0 * sin(0.4 * row));
        }
    }
    assert_true(icp_between(&sim_method_icp_upper, a, b) < 0.02);
    assert_true(icp_between(&sim_method_icp, a, b) > 0.1);
    sim_scan_free(a);
    sim_scan_free(b);
}

static void test_icp_wants_overlap(void **state)
{
    (void)state;
    struct sim_scan *a = drawn_face(5, 0.0, 0), *b = drawn_face(5, 0.0, 0);
    for (int i = 0; i < DRAWN_SIDE * DRAWN_SIDE; i++) { /* a has the left half, b the right half */
        a->measured[i] = a->measured[i] && i % DRAWN_SIDE < DRAWN_SIDE / 2 - 4;
        b->measured[i] = b->measured[i] && i % DRAWN_SIDE > DRAWN_SIDE / 2 + 4;
    }
    void *probe = described(&sim_method_icp, NULL, a),
         *gallery = described(&sim_method_icp, NULL, b);
    double d = -1.0;
    assert_int_equal(sim_method_icp.distance(NULL, probe, gallery, &d), -ENODATA);
    assert_float_equal(d, -1.0, 0.0);
    sim_method_icp.discard(probe);
    sim_method_icp.discard(gallery);
    memset(a->measured, 0, sim_scan_pixels(a));
    void *nothing = NULL;
    assert_int_equal(sim_method_icp.describe(NULL, a, &nothing), -ENODATA);
    assert_null(nothing);
    sim_scan_free(a);
    sim_scan_free(b);
}

static double weighted_between(const struct sim_scan *a, const struct sim_scan *b)
{
    return icp_between(&sim_method_hfpc_weighted, a, b);
}

/* Contours of heat on a weighted surface. Skin of even brightness has no effect, but its pattern
 * has one. Without an image there is no description. */
static void test_skin_bends_contours(void **state)
{
    (void)state;
    struct sim_scan *plain = drawn_face(5, 0.0, 0), *bright = drawn_face(5, 0.0, 0),
                    *spotted = drawn_face(5, 0.0, 0), *blind = drawn_face(5, 0.0, 0);
    for (int i = 0; i < DRAWN_SIDE * DRAWN_SIDE; i++) {
        plain->reflectance[i] = 1.0f;
        bright->reflectance[i] = 2.5f;
    }
    double evenly = weighted_between(plain, bright), bent = weighted_between(plain, spotted);
    drawn_skin(bright, 5, 2.5);
    double scaled = weighted_between(spotted, bright);
    print_message("evenly brighter %.4f mm, spotted %.4f mm, spotted and brighter %.4f mm\n",
                  evenly, bent, scaled);
    assert_true(evenly < 1e-3 && scaled < 1e-3);
    assert_true(bent > 0.1);
    free(blind->reflectance);
    blind->reflectance = NULL;
    void *description = NULL;
    assert_int_equal(sim_method_hfpc_weighted.describe(NULL, blind, &description), -ENODATA);
    assert_null(description);
    sim_scan_free(plain);
    sim_scan_free(bright);
    sim_scan_free(spotted);
    sim_scan_free(blind);
}

/* The control method uses no image. It equals the weighted method on skin without a pattern. */
static void test_control_weighs_nothing(void **state)
{
    (void)state;
    const struct sim_method *control = &sim_method_hfpc_weighted_1,
                            *weighted = &sim_method_hfpc_weighted;
    struct sim_scan *plain = drawn_face(5, 0.0, 0), *spotted = drawn_face(5, 0.0, 0);
    for (int i = 0; i < DRAWN_SIDE * DRAWN_SIDE; i++) {
        plain->reflectance[i] = 1.0f;
    }
    void *weightless = described(weighted, NULL, plain),
         *controlled = described(control, NULL, spotted);
    assert_float_equal(method_distance(control, NULL, controlled, weightless), 0.0, 0.0);
    control->discard(controlled);
    free(spotted->reflectance);
    spotted->reflectance = NULL;
    controlled = described(control, NULL, spotted);
    assert_float_equal(method_distance(control, NULL, controlled, weightless), 0.0, 0.0);
    control->discard(controlled);
    weighted->discard(weightless);
    sim_scan_free(plain);
    sim_scan_free(spotted);
}

static double plane(const void *context, double x, double y)
{
    (void)y;
    return *(const double *)context * x;
}

/* A cylinder about the y axis. It unrolls to a plane. */
static double cylinder(const void *context, double x, double y)
{
    (void)y;
    double r = *(const double *)context;
    return sqrt(r * r - x * x) - r;
}

static double geodesic(const struct sim_scan *scan, struct iso_vec3 from, struct iso_vec3 to)
{
    struct sim_geodesic *g = NULL;
    double d = NAN;
    assert_int_equal(sim_geodesic_new(scan, &g), 0);
    assert_int_equal(sim_geodesic_from(g, scan, from, &to, 1, &d), 0);
    sim_geodesic_free(g);
    return d;
}

static void test_geodesics(void **state)
{
    (void)state;
    double slope = 0.75, r = 100.0;
    struct sim_scan *tilted = drawn_surface(plane, &slope), *round = drawn_surface(cylinder, &r);
    struct sim_random random = sim_random_seeded(4, 4, 4);
    for (int i = 0; i < 12; i++) {
        struct iso_vec3 a = {sim_random_between(&random, -50.0, 50.0),
                             sim_random_between(&random, -50.0, 50.0), 0.0};
        struct iso_vec3 b = {sim_random_between(&random, -50.0, 50.0),
                             sim_random_between(&random, -50.0, 50.0), 0.0};
        double flat = hypot(1.25 * (a.x - b.x), a.y - b.y);
        double bent = hypot(r * (asin(a.x / r) - asin(b.x / r)), a.y - b.y);
        double tilted_mm = geodesic(tilted, a, b), bent_mm = geodesic(round, a, b);
        /* In a plane that is seen straight, a path is at most 1.4 % too long. A tilted plane
         * stretches the directions of the steps. */
        assert_true(tilted_mm > flat - 1e-6 && tilted_mm < 1.02 * flat + 0.6 * DRAWN_SPACING_MM);
        assert_true(bent_mm > 0.998 * bent && bent_mm < 1.02 * bent + 0.6 * DRAWN_SPACING_MM);
    }
    struct sim_geodesic *g = NULL;
    struct iso_vec3 inside = {0.0, 0.0, 0.0}, outside = {89.0, 89.0, 0.0};
    double d = -1.0;
    assert_int_equal(sim_geodesic_new(round, &g), 0);
    assert_int_equal(sim_geodesic_from(g, round, inside, &outside, 1, &d), -ENODATA);
    assert_int_equal(sim_geodesic_from(g, round, outside, &inside, 1, &d), -ENODATA);
    assert_float_equal(d, -1.0, 0.0);
    sim_geodesic_free(g);
    sim_scan_free(tilted);
    sim_scan_free(round);
}

static void test_contours_need_a_surface(void **state)
{
    (void)state;
    struct sim_scan *scan = drawn_face(5, 0.0, 0);
    void *description = NULL;
    scan->source_mm[3] = iso_vec3(89.0, 89.0, 0.0);
    assert_int_equal(sim_method_hfpc_literal.describe(NULL, scan, &description), -ENODATA);
    assert_null(description);
    sim_scan_free(scan);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_icp_moves_faces),
        cmocka_unit_test(test_icp_upper_looks_above),
        cmocka_unit_test(test_icp_wants_overlap),
        cmocka_unit_test(test_skin_bends_contours),
        cmocka_unit_test(test_control_weighs_nothing),
        cmocka_unit_test(test_geodesics),
        cmocka_unit_test(test_contours_need_a_surface),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
