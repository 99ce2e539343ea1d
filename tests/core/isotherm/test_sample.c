/* Curves sampled by polar angle and by arc length. */
#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "isotherm/isotherm_curve.h"

static const struct iso_vec3 origin = {0, 0, 0};

/* A rectangle about (10, 20), at x 6..18 and y 17..25, with z = x + 2 y; counter-clockwise. */
static const struct iso_vec3 box[] = {{18, 17, 52}, {18, 25, 68}, {6, 25, 56}, {6, 17, 40}};
static const struct iso_vec3 box_centre = {10, 20, 50};

static void expect_point(struct iso_vec3 p, double x, double y)
{
    assert_true(fabs(p.x - x) < 1e-12 && fabs(p.y - y) < 1e-12 && fabs(p.z - (x + 2 * y)) < 1e-12);
}

static void polar_samples_start_at_y_and_turn_to_minus_x(void **state)
{
    (void)state;
    const struct iso_curve curve = {4, true, box};
    struct iso_isotherm s;
    assert_int_equal(iso_isotherm_sample_polar(curve, box_centre, 8, &s), 0);
    assert_int_equal(s.n, 8);
    assert_true(s.closed);
    expect_point(s.points_mm[0], 10, 25);
    expect_point(s.points_mm[1], 6, 24); /* 45 degrees towards -x */
    expect_point(s.points_mm[2], 6, 20);
    expect_point(s.points_mm[3], 7, 17);
    expect_point(s.points_mm[4], 10, 17);
    expect_point(s.points_mm[5], 13, 17);
    expect_point(s.points_mm[6], 18, 20);
    expect_point(s.points_mm[7], 15, 25);
    for (int i = 0; i < 8; i++) {
        assert_true(s.weight[i] == 1.0f);
    }
}

static void of_several_crossings_the_farthest_counts(void **state)
{
    (void)state;
    /* An arm reaches out to +x and back above it, so that rays near +x cross the curve three times.
     */
    const struct iso_vec3 points[] = {{-5, -5, 0}, {12, -5, 0}, {12, 3, 0}, {9, 3, 0},
                                      {9, -3, 0},  {5, -3, 0},  {5, 5, 0},  {-5, 5, 0}};
    const struct iso_curve curve = {8, true, points};
    struct iso_isotherm s;
    assert_int_equal(iso_isotherm_sample_polar(curve, origin, 4, &s), 0);
    assert_true(fabs(s.points_mm[3].x - 12.0) < 1e-12 && fabs(s.points_mm[3].y) < 1e-12);
    assert_true(fabs(s.points_mm[1].x + 5.0) < 1e-12);
}

static void arc_samples_are_equally_spaced(void **state)
{
    (void)state;
    enum { N = 20 };                                                   /* on a closed curve */
    const struct iso_vec3 turned[] = {box[3], box[2], box[1], box[0]}; /* clockwise */
    for (int direction = 0; direction < 2; direction++) {
        const struct iso_curve curve = {4, true, direction ? turned : box};
        struct iso_isotherm s;
        assert_int_equal(iso_isotherm_sample_arc(curve, box_centre, N, &s), 0);
        assert_int_equal(s.n, N);
        /* The samples start at the point closest to the +y direction and go on towards -x, in
         * either direction of the traced curve. */
        assert_true(s.points_mm[0].y > 24.9);
        /* Two neighbours are a step apart along the curve. A straight line between them is as long,
         * except around the four corners, where it is shorter. */
        const double step_mm =
            2.0 * (iso_norm(iso_sub(box[1], box[0])) + iso_norm(iso_sub(box[2], box[1]))) / N;
        int straight = 0;
        for (int i = 0; i < N; i++) {
            assert_true(s.weight[i] == 1.0f);
            struct iso_vec3 a = s.points_mm[i], b = s.points_mm[(i + 1) % N];
            struct iso_vec3 u = iso_sub(a, box_centre), v = iso_sub(b, box_centre);
            assert_true(u.x * v.y - u.y * v.x > 0.0);
            assert_true(iso_norm(iso_sub(b, a)) < step_mm + 1e-9);
            straight += iso_norm(iso_sub(b, a)) > step_mm - 1e-9;
            /* The samples are in the plane z = x + 2 y of the curve. */
            assert_true(fabs(a.z - (a.x + 2 * a.y)) < 1e-9);
        }
        assert_true(straight >= N - 4);
    }
    const struct iso_vec3 line[] = {{0, 0, 0}, {3, 0, 4}, {6, 0, 8}}; /* open, 10 mm long */
    const struct iso_curve open = {3, false, line};
    struct iso_isotherm s;
    assert_int_equal(iso_isotherm_sample_arc(open, iso_vec3(3, -1, 0), 5, &s), 0);
    assert_false(s.closed);
    for (int i = 0; i + 1 < 5; i++) {
        assert_true(fabs(iso_norm(iso_sub(s.points_mm[i + 1], s.points_mm[i])) - 2.5) < 1e-9);
    }
}

static void impossible_samples_are_refused(void **state)
{
    (void)state;
    const struct iso_curve curve = {4, true, box}, stub = {2, false, box};
    struct iso_isotherm s = {.n = -7};
    assert_int_equal(iso_isotherm_sample_polar(curve, origin, 3, &s), -EINVAL);
    assert_int_equal(iso_isotherm_sample_polar(curve, origin, ISO_ISOTHERM_POINTS_MAX + 1, &s),
                     -EINVAL);
    assert_int_equal(iso_isotherm_sample_polar(stub, origin, 8, &s), -EINVAL);
    assert_int_equal(iso_isotherm_sample_arc(curve, origin, 3, &s), -EINVAL);
    assert_int_equal(iso_isotherm_sample_arc(curve, origin, ISO_ISOTHERM_POINTS_MAX + 1, &s),
                     -EINVAL);
    assert_int_equal(iso_isotherm_sample_arc(stub, origin, 8, &s), -EINVAL);
    assert_int_equal(s.n, -7);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(polar_samples_start_at_y_and_turn_to_minus_x),
        cmocka_unit_test(of_several_crossings_the_farthest_counts),
        cmocka_unit_test(arc_samples_are_equally_spaced),
        cmocka_unit_test(impossible_samples_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
