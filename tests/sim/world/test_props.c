/* Solids of the simulated world, compared with closed forms: lengths, radii, volumes, shares. */
#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "sim/world/prop/group.h"
#include "sim/world/prop/screen.h"
#include "sim/world/prop/sheet.h"
#include "tests/sim/world/solid_measure.h"

static const double pi = 3.14159265358979324;

static long allocations_left = -1; /* until one fails; negative: none fails */

void *__real_calloc(size_t n, size_t size);
void *__wrap_calloc(size_t n, size_t size);
void *__real_malloc(size_t size);
void *__wrap_malloc(size_t size);
void *__real_realloc(void *block, size_t size);
void *__wrap_realloc(void *block, size_t size);

static bool denied(void)
{
    return allocations_left >= 0 && allocations_left-- == 0;
}

void *__wrap_calloc(size_t n, size_t size)
{
    return denied() ? NULL : __real_calloc(n, size);
}

void *__wrap_malloc(size_t size)
{
    return denied() ? NULL : __real_malloc(size);
}

void *__wrap_realloc(void *block, size_t size)
{
    return denied() ? NULL : __real_realloc(block, size);
}

static void a_tube_is_a_cylinder_between_two_half_spheres(void **state)
{
    (void)state;
    const struct sim_joint joints[] = {
        {{3.0, -7.0, 20.0}, 9.0}, {{9.0, 5.0, 32.0}, 9.0}, {{33.0, 53.0, 80.0}, 9.0}};
    struct sim_solid *tube = NULL;
    assert_int_equal(sim_solid_tube(joints, 3, SIM_SKIN, &tube), 0);
    double length = iso_norm(iso_sub(joints[2].at_mm, joints[0].at_mm));
    double exact = pi * 81.0 * length + 4.0 / 3.0 * pi * 729.0;
    double share = fabs(solid_volume(tube)) /
                   exact; /* a polygon of 16 sides has 0.974 of its circle's area */
    print_message("tube: volume %.4f of the round one\n", share);
    assert_true(share > 0.955 && share < 0.985);
    for (uint32_t i = 0; i < tube->n_vertices; i++) {
        struct iso_vec3 along = iso_unit(iso_sub(joints[2].at_mm, joints[0].at_mm));
        struct iso_vec3 from = iso_sub(tube->vertices_mm[i], joints[0].at_mm);
        double s = fmin(fmax(iso_dot(from, along), 0.0), length);
        assert_true(fabs(iso_norm(iso_madd(from, -s, along)) - 9.0) < 1e-9);
    }
    sim_solid_free(tube);
}

static void a_superellipsoid_runs_from_ellipsoid_to_box(void **state)
{
    (void)state;
    const struct iso_vec3 half = {30.0, 50.0, 20.0};
    double eighth = half.x * half.y * half.z;
    struct sim_solid *round = NULL, *square = NULL;
    assert_int_equal(sim_solid_superellipsoid(half, 1.0, SIM_SKIN, &round), 0);
    assert_int_equal(sim_solid_superellipsoid(half, 0.05, SIM_SKIN, &square), 0);
    print_message("superellipsoids: %.3f of the ellipsoid, %.3f of the box\n",
                  fabs(solid_volume(round)) / (4.0 / 3.0 * pi * eighth),
                  fabs(solid_volume(square)) / (8.0 * eighth));
    assert_true(fabs(fabs(solid_volume(round)) / (4.0 / 3.0 * pi * eighth) - 1.0) < 0.02);
    assert_true(fabs(fabs(solid_volume(square)) / (8.0 * eighth) - 1.0) < 0.06);
    sim_solid_free(round);
    sim_solid_free(square);
}

static void a_thickened_sheet_has_a_volume(void **state)
{
    (void)state;
    struct sim_solid *sheet = NULL;
    assert_int_equal(sim_solid_rectangle(120.0, 70.0, 0.0, SIM_PLASTIC, &sheet), 0);
    assert_int_equal(sim_solid_thicken(sheet, 2.0), 0);
    assert_true(fabs(solid_volume(sheet) - 120.0 * 70.0 * 2.0) < 1e-6);
    assert_true(fabs(solid_area(sheet) - 2.0 * (120.0 * 70.0 + 2.0 * 120.0 + 2.0 * 70.0)) < 1e-6);
    sim_solid_free(sheet);
}

static struct sim_sheet sheet_of(enum sim_sheet_shape shape, double radius_mm)
{
    return (struct sim_sheet){.width_mm = 148.0,
                              .height_mm = 210.0,
                              .shape = shape,
                              .radius_mm = radius_mm,
                              .crease_rad = 0.5,
                              .axis_rad = 0.6};
}

/* Bending keeps lengths, so that every small step on the sheet keeps its length, too. */
static void paper_does_not_stretch(void **state)
{
    (void)state;
    for (int shape = SIM_SHEET_FLAT; shape <= SIM_SHEET_CREASED; shape++) {
        struct sim_sheet sheet = sheet_of((enum sim_sheet_shape)shape, -90.0);
        for (int i = 0; i < 400; i++) {
            double x = 7.3 * (i % 20) - 70.1, y = 10.1 * (i / 20) - 101.0;
            struct iso_vec3 here = sim_sheet_point(&sheet, x, y);
            struct iso_vec3 right = sim_sheet_point(&sheet, x + 1e-4, y);
            struct iso_vec3 down = sim_sheet_point(&sheet, x, y + 1e-4);
            assert_true(fabs(iso_norm(iso_sub(right, here)) - 1e-4) < 1e-8);
            assert_true(fabs(iso_norm(iso_sub(down, here)) - 1e-4) < 1e-8);
        }
    }
}

static void a_rolled_sheet_has_its_radius(void **state)
{
    (void)state;
    for (int sign = -1; sign <= 1; sign += 2) {
        struct sim_sheet sheet = sheet_of(SIM_SHEET_ROLLED, sign * 80.0);
        struct sim_solid *solid = NULL;
        struct iso_vec3 axis = {-sin(0.6), cos(0.6), 0.0}, on_axis = {0.0, 0.0, sign * 80.0};
        assert_int_equal(sim_sheet_new(&sheet, SIM_PAPER, &solid), 0);
        for (uint32_t i = 0; i < solid->n_vertices; i++) {
            struct iso_vec3 from = iso_sub(solid->vertices_mm[i], on_axis);
            double distance = iso_norm(iso_madd(from, -iso_dot(from, axis), axis));
            assert_true(fabs(distance - 80.0) < 1e-9);
            assert_true(sign * solid->vertices_mm[i].z >= 0.0);
        }
        assert_true(fabs(solid_area(solid) / (148.0 * 210.0) - 1.0) < 1e-3);
        sim_solid_free(solid);
    }
}

static void a_crease_makes_two_planes(void **state)
{
    (void)state;
    struct sim_sheet sheet = sheet_of(SIM_SHEET_CREASED, 0.0);
    struct sim_solid *solid = NULL;
    assert_int_equal(sim_sheet_new(&sheet, SIM_PAPER, &solid), 0);
    for (uint32_t i = 0; i < solid->n_vertices; i++) {
        struct iso_vec3 p = solid->vertices_mm[i];
        double across = cos(0.6) * p.x + sin(0.6) * p.y;
        assert_true(fabs(p.z - tan(0.5) * fabs(across)) < 1e-9);
    }
    sim_solid_free(solid);
}

static void an_outline_cuts_the_corners_off(void **state)
{
    (void)state;
    struct sim_sheet sheet = sheet_of(SIM_SHEET_FLAT, 0.0);
    struct sim_solid *solid = NULL;
    sheet.outline = true;
    assert_int_equal(sim_sheet_new(&sheet, SIM_PAPER, &solid), 0);
    double share = solid_area(solid) / (148.0 * 210.0);
    print_message("outline: %.3f of the sheet\n", share);
    assert_true(share > 0.70 && share < 0.85); /* an ellipse has 0.785 */
    sim_solid_free(solid);
}

static double area_of(const struct sim_group *group, enum sim_material material)
{
    double sum = 0.0;
    for (size_t i = 0; i < group->n_solids; i++) {
        sum += group->solids[i]->material == material ? solid_area(group->solids[i]) : 0.0;
    }
    return sum;
}

static void a_screen_loses_the_share_it_should(void **state)
{
    (void)state;
    static const double shares[] = {0.0, 0.37, 0.9, 1.0};
    for (size_t i = 0; i < sizeof shares / sizeof *shares; i++) {
        struct sim_screen screen = {.width_mm = 160.0,
                                    .height_mm = 230.0,
                                    .rim_mm = 9.0,
                                    .thickness_mm = 7.0,
                                    .lost = shares[i],
                                    .patch_mm = 40.0,
                                    .key = 5};
        struct sim_group *group = NULL;
        assert_int_equal(sim_group_new(&group), 0);
        sim_screen_add(group, &screen);
        assert_int_equal(group->error, 0);
        double lost = area_of(group, SIM_MIRROR), kept = area_of(group, SIM_GLASS);
        assert_true(fabs(lost + kept - 160.0 * 230.0) < 1e-6);
        assert_true(fabs(lost / (160.0 * 230.0) - shares[i]) < 1e-3);
        sim_group_free(group);
    }
}

static void bad_arguments_are_refused(void **state)
{
    (void)state;
    struct sim_solid *solid = NULL;
    struct sim_sheet sheet = sheet_of(SIM_SHEET_ROLLED, 0.0);
    const struct sim_joint thin[] = {{{0, 0, 0}, 1.0}, {{0, 0, 9}, 0.0}};
    const struct iso_vec3 half = {1, 2, 3}, empty = {1, 0, 3};
    assert_int_equal(sim_sheet_new(&sheet, SIM_PAPER, &solid), -EINVAL);
    sheet = sheet_of(SIM_SHEET_FLAT, 0.0);
    sheet.height_mm = 0.0;
    assert_int_equal(sim_sheet_new(&sheet, SIM_PAPER, &solid), -EINVAL);
    assert_int_equal(sim_solid_tube(thin, 2, SIM_SKIN, &solid), -EINVAL);
    assert_int_equal(sim_solid_tube(thin, 1, SIM_SKIN, &solid), -EINVAL);
    assert_int_equal(sim_solid_superellipsoid(empty, 1.0, SIM_SKIN, &solid), -EINVAL);
    assert_int_equal(sim_solid_superellipsoid(half, 0.0, SIM_SKIN, &solid), -EINVAL);
    assert_int_equal(sim_solid_superellipsoid(half, 1.1, SIM_SKIN, &solid), -EINVAL);
    assert_null(solid);
}

/* A group keeps the first failure, and keeps none of the solids that are added later. */
static void every_allocation_may_fail(void **state)
{
    (void)state;
    const struct sim_screen screen = {.width_mm = 60.0,
                                      .height_mm = 90.0,
                                      .rim_mm = 4.0,
                                      .thickness_mm = 7.0,
                                      .lost = 0.5,
                                      .patch_mm = 20.0,
                                      .keyboard = true};
    int failures = 0;
    for (long n = 0;; n++) {
        struct sim_group *group = NULL;
        allocations_left = n;
        int error = sim_group_new(&group);
        if (error == 0) {
            sim_screen_add(group, &screen);
            error = group->error;
        }
        bool failed = allocations_left < 0;
        allocations_left = -1;
        sim_group_free(group);
        if (!failed) {
            assert_int_equal(error, 0);
            break;
        }
        assert_int_equal(error, -ENOMEM);
        failures++;
    }
    print_message("%d allocations failed in turn\n", failures);
    assert_true(failures > 20);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_tube_is_a_cylinder_between_two_half_spheres),
        cmocka_unit_test(a_superellipsoid_runs_from_ellipsoid_to_box),
        cmocka_unit_test(a_thickened_sheet_has_a_volume),
        cmocka_unit_test(paper_does_not_stretch),
        cmocka_unit_test(a_rolled_sheet_has_its_radius),
        cmocka_unit_test(a_crease_makes_two_planes),
        cmocka_unit_test(an_outline_cuts_the_corners_off),
        cmocka_unit_test(a_screen_loses_the_share_it_should),
        cmocka_unit_test(bad_arguments_are_refused),
        cmocka_unit_test(every_allocation_may_fail),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
