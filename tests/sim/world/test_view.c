/* The view and the solids that are drawn into it. */
#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "sim/world/prop/solid.h"
#include "sim/world/view/view.h"

static const struct iso_camera camera = {.projection = ISO_PINHOLE,
                                         .width_px = 120,
                                         .height_px = 90,
                                         .fx_px = 100.0,
                                         .fy_px = 110.0,
                                         .cx_px = 50.0,
                                         .cy_px = 40.0};

static size_t at(const struct sim_view *view, int column, int row)
{
    return (size_t)row * (size_t)view->camera.width_px + (size_t)column;
}

static void draw(struct sim_view *view, const struct sim_solid *solid, struct iso_vec3 where_mm,
                 struct iso_vec3 turn_rad)
{
    struct iso_vec3 scratch[256];
    struct iso_rigid placed = {iso_mat3_rotation(turn_rad), where_mm};
    assert_int_equal(sim_solid_draw(solid, &placed, scratch, view), 0);
}

static void cosine_and_material_are_those_of_the_nearest(void **state)
{
    (void)state;
    struct sim_view *view;
    struct sim_solid *wall, *box;
    assert_int_equal(sim_view_new(&camera, 1, &view), 0);
    assert_int_equal(sim_solid_rectangle(4000.0, 4000.0, 0.0, SIM_WALL, &wall), 0);
    assert_int_equal(sim_solid_box(iso_vec3(100.0, 60.0, 80.0), SIM_CLOTH, &box), 0);
    draw(view, wall, iso_vec3(0, 0, 800), iso_vec3(0, 0.4, 0));
    draw(view, box, iso_vec3(0, 0, 540), iso_vec3(0, 0, 0));
    sim_view_finish(view);
    size_t on_box = at(view, 50, 40), on_wall = at(view, 80, 40), corner = at(view, 50 + 9, 40 + 6);
    assert_true(fabsf(view->depth_mm[on_box] - 500.0f) < 1e-3f); /* its front: 540 - 80 / 2 */
    assert_int_equal(view->material[on_box], SIM_CLOTH);
    assert_true(fabsf(view->cosine[on_box] - 1.0f) < 1e-6f);
    assert_int_equal(view->material[corner], SIM_CLOTH);
    assert_int_equal(view->material[on_wall], SIM_WALL);
    /* the wall's normal (sin 0.4, 0, cos 0.4) and the sight line along (0.3, 0, 1) */
    double expected = (0.3 * sin(0.4) + cos(0.4)) / sqrt(1.09);
    assert_true(fabs((double)view->cosine[on_wall] - expected) < 1e-5);
    sim_view_clear(view);
    assert_int_equal(view->material[on_box], SIM_NOTHING);
    assert_true(view->depth_mm[on_box] <= 0.0f && view->cosine[on_box] <= 0.0f);
    sim_solid_free(wall);
    sim_solid_free(box);
    sim_view_free(view);
}

/* The four samples of a pixel are around its centre. Their mean is the plane's depth there. */
static void supersampling_keeps_pixel_centres(void **state)
{
    (void)state;
    struct sim_view *one, *four;
    struct sim_solid *wall;
    assert_int_equal(sim_view_new(&camera, 1, &one), 0);
    assert_int_equal(sim_view_new(&camera, 2, &four), 0);
    assert_int_equal(four->camera.width_px, 240);
    assert_int_equal(sim_solid_rectangle(4000.0, 4000.0, 0.0, SIM_WALL, &wall), 0);
    draw(one, wall, iso_vec3(0, 0, 800), iso_vec3(0.2, 0.3, 0));
    draw(four, wall, iso_vec3(0, 0, 800), iso_vec3(0.2, 0.3, 0));
    for (int row = 0; row < 90; row += 7) {
        for (int column = 0; column < 120; column += 11) {
            double sum = 0.0;
            for (int k = 0; k < 4; k++) {
                sum += (double)four->depth_mm[at(four, 2 * column + k % 2, 2 * row + k / 2)];
            }
            assert_true(fabs(sum / 4.0 - (double)one->depth_mm[at(one, column, row)]) < 0.02);
        }
    }
    sim_solid_free(wall);
    sim_view_free(one);
    sim_view_free(four);
}

/* A sheet bent to radius R about a vertical axis: at arc length s it lies R (1 - cos(s / R))
 * farther away. */
static void a_bent_sheet_is_a_cylinder(void **state)
{
    (void)state;
    struct sim_solid *sheet;
    assert_int_equal(sim_solid_rectangle(200.0, 100.0, 120.0, SIM_PAPER, &sheet), 0);
    double half = 0.0, length = 0.0;
    for (uint32_t i = 0; i < sheet->n_vertices; i++) {
        struct iso_vec3 p = sheet->vertices_mm[i];
        half = fmax(half, fabs(p.x));
        length = fmax(length, fabs(p.y));
        assert_true(fabs(p.x * p.x + (p.z - 120.0) * (p.z - 120.0) - 120.0 * 120.0) < 1e-6);
    }
    assert_true(fabs(half - 120.0 * sin(100.0 / 120.0)) < 1e-9);
    assert_true(fabs(length - 50.0) < 1e-9);
    sim_solid_free(sheet);
}

static void bad_arguments_are_refused(void **state)
{
    (void)state;
    struct iso_camera bad = camera;
    struct sim_view *view = NULL;
    struct sim_solid *solid = NULL;
    bad.fx_px = NAN;
    assert_int_equal(sim_view_new(&bad, 1, &view), -EINVAL);
    assert_int_equal(sim_view_new(&camera, 0, &view), -EINVAL);
    assert_int_equal(sim_view_new(&camera, 5, &view), -EINVAL);
    assert_int_equal(sim_solid_new(0, 4, SIM_PAPER, &solid), -EINVAL);
    assert_int_equal(sim_solid_sheet(1, 4, SIM_PAPER, &solid), -EINVAL);
    assert_int_equal(sim_solid_rectangle(-1.0, 4.0, 0.0, SIM_PAPER, &solid), -EINVAL);
    assert_int_equal(sim_solid_box(iso_vec3(1, 0, 1), SIM_PAPER, &solid), -EINVAL);
    assert_null(view);
    assert_null(solid);
}

/* A second eye 60 mm to the right sees objects f 60 / z pixels farther left, and misses no facet.
 */
static void a_companion_sees_the_same_from_elsewhere(void **state)
{
    (void)state;
    struct sim_view *view, *other;
    struct sim_solid *wall, *box;
    assert_int_equal(sim_view_new(&camera, 1, &view), 0);
    assert_int_equal(sim_view_new(&camera, 1, &other), 0);
    view->companions[0] = (struct sim_companion){other, iso_rigid_identity()};
    view->companions[0].companion_from_view.translation_mm.x = -60.0;
    view->n_companions = 1;
    assert_int_equal(sim_solid_rectangle(4000.0, 4000.0, 0.0, SIM_WALL, &wall), 0);
    assert_int_equal(sim_solid_box(iso_vec3(100.0, 60.0, 80.0), SIM_CLOTH, &box), 0);
    draw(view, wall, iso_vec3(0, 0, 800), iso_vec3(0, 0, 0));
    draw(view, box, iso_vec3(0, 0, 540), iso_vec3(0, 0, 0));
    sim_view_finish(view);
    int shift = 12; /* of the front, 100 * 60 / 500 */
    assert_int_equal(other->n_facets, view->n_facets);
    for (int column = 50 - 9; column <= 50 + 9; column++) {
        assert_int_equal(view->material[at(view, column, 40)], SIM_CLOTH);
        assert_int_equal(other->material[at(other, column - shift, 40)], SIM_CLOTH);
        assert_true(fabsf(other->depth_mm[at(other, column - shift, 40)] - 500.0f) < 1e-3f);
    }
    assert_int_equal(other->material[at(other, 50 + 9, 40)], SIM_WALL);
    sim_view_clear(view);
    assert_true(!(other->depth_mm[at(other, 50, 40)] > 0.0f));
    sim_solid_free(wall);
    sim_solid_free(box);
    sim_view_free(view);
    sim_view_free(other);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(cosine_and_material_are_those_of_the_nearest),
        cmocka_unit_test(supersampling_keeps_pixel_centres),
        cmocka_unit_test(a_bent_sheet_is_a_cylinder),
        cmocka_unit_test(a_companion_sees_the_same_from_elsewhere),
        cmocka_unit_test(bad_arguments_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
