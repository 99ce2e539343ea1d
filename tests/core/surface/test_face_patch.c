/* The face patch on surfaces made from the mean face, for which the correct patch is known. */
#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "core/surface/face_patch.h"
#include "core/surface/raster.h"
#include "tests/core/surfaces/rendered_head.h"
#include "tests/core/surfaces/shipped_model.h"

static const struct iso_face_patch_options usual = {
    .radius_mm = 100.0, .spacing_mm = 2.0, .smoothing_mm = 3.0, .outlier_mm = 20.0};

/* A place on the cheek, in the face frame, and the radius of the change at this place. */
static const double cheek_x_mm = -35.0, cheek_y_mm = -22.0, spot_mm = 10.0;

struct fixture {
    struct iso_head_model *model;
    struct iso_rigid pose;
    struct iso_face_patch *patch;
    struct iso_vec3 *shape;
    float *mean; /* depths of the mean face on the patch's grid */
    int side;
};

static int set_up(void **state)
{
    struct fixture *f = calloc(1, sizeof *f);
    assert_non_null(f);
    f->model = shipped_head_model();
    f->pose = rendered_head_pose(-17.0, 9.0, iso_vec3(40, -25, 610));
    f->shape = calloc(f->model->n_vertices, sizeof *f->shape);
    assert_non_null(f->shape);
    assert_int_equal(iso_face_patch_new(f->model, &usual, &f->patch), 0);
    const struct iso_frame *frame = iso_face_patch_frame(f->patch);
    f->side = frame->width_px;
    f->mean = calloc((size_t)(f->side * f->side), sizeof *f->mean);
    assert_non_null(f->mean);
    for (uint32_t i = 0; i < f->model->n_vertices; i++) {
        f->shape[i] = iso_patch_from_face(f->model->mean_mm[i]);
    }
    const struct iso_raster raster = {
        .camera = frame->camera, .width_px = f->side, .height_px = f->side, .depth_mm = f->mean};
    iso_raster_triangles(&raster, f->shape, (const uint32_t(*)[3])f->model->triangles,
                         (int32_t)f->model->n_triangles, 0, 1.0, 1);
    memcpy(f->shape, f->model->mean_mm, f->model->n_vertices * sizeof *f->shape);
    *state = f;
    return 0;
}

static int tear_down(void **state)
{
    struct fixture *f = *state;
    iso_face_patch_free(f->patch);
    iso_head_model_free(f->model);
    free(f->shape);
    free(f->mean);
    free(f);
    return 0;
}

/* The distance of a test's shape in front of the mean face. It is harmonic, so that a membrane over
 * a hole in it has its values; it changes slowly, so that smoothing does not change it. */
static double relief_mm(double x_mm, double y_mm)
{
    return 2.0 + 0.03 * x_mm - 0.02 * y_mm + 0.0004 * (x_mm * x_mm - y_mm * y_mm);
}

static void raise_relief(struct fixture *f)
{
    for (uint32_t i = 0; i < f->model->n_vertices; i++) {
        f->shape[i].z += relief_mm(f->shape[i].x, f->shape[i].y);
    }
}

/* Removes the triangles that touch the spot on the cheek. */
static void cut_spot(const struct fixture *f, struct iso_mesh *mesh)
{
    int32_t kept = 0;
    for (int32_t t = 0; t < mesh->n_triangles; t++) {
        bool touched = false;
        for (int k = 0; k < 3; k++) {
            struct iso_vec3 p = f->shape[mesh->triangles[t][k]];
            touched |= hypot(p.x - cheek_x_mm, p.y - cheek_y_mm) < spot_mm;
        }
        if (!touched) {
            memmove(mesh->triangles[kept++], mesh->triangles[t], sizeof mesh->triangles[0]);
        }
    }
    assert_true(kept < mesh->n_triangles);
    mesh->n_triangles = kept;
}

static double build(struct fixture *f, struct iso_mesh *mesh)
{
    double coverage = iso_face_patch_build(f->patch, mesh, &f->pose);
    iso_mesh_free(mesh);
    return coverage;
}

static float depth_at(const struct fixture *f, double x_mm, double y_mm)
{
    double column, row;
    iso_face_patch_pixel(f->patch, x_mm, y_mm, &column, &row);
    return iso_frame_depth_at(iso_face_patch_frame(f->patch), (int)lround(column),
                              (int)lround(row));
}

static void the_mean_face_has_no_residual(void **state)
{
    struct fixture *f = *state;
    double coverage = build(f, rendered_head_mesh(f->model, NULL, &f->pose));
    const struct iso_frame *frame = iso_face_patch_frame(f->patch);
    int inside = 0;
    for (int i = 0; i < f->side * f->side; i++) {
        if (frame->depth_mm[i] > 0.0f) {
            assert_true(fabsf(frame->depth_mm[i] - f->mean[i]) < 1e-3f);
            inside++;
        }
    }
    assert_true(coverage > 0.999 && coverage <= 1.0);
    /* The domain is most of the disc of 100 mm, because the mean face is narrower than the disc. */
    double area_mm2 = inside * usual.spacing_mm * usual.spacing_mm;
    assert_true(area_mm2 > 15000.0 && area_mm2 < M_PI * 100.0 * 100.0);
    assert_int_equal(iso_frame_check(frame, NULL), 0);
}

static void the_nose_tip_is_in_the_middle(void **state)
{
    struct fixture *f = *state;
    (void)build(f, rendered_head_mesh(f->model, NULL, &f->pose));
    double column, row;
    iso_face_patch_pixel(f->patch, 0.0, 0.0, &column, &row);
    assert_true(column == (f->side - 1) / 2 && row == (f->side - 1) / 2);
    assert_true(fabs((double)depth_at(f, 0, 0) - ISO_FACE_PATCH_ORIGIN_MM) < 1.0);
    /* x to the right, y upwards; the image's rows go down. */
    iso_face_patch_pixel(f->patch, 30.0, 11.0, &column, &row);
    assert_true(column == (f->side - 1) / 2 + 15.0 && row == (f->side - 1) / 2 - 5.5);
    struct iso_vec3 p = iso_frame_point_at(iso_face_patch_frame(f->patch), (int)column,
                                           (f->side - 1) / 2 - 5);
    p = iso_face_from_patch(p);
    assert_true(fabs(p.x - 30.0) < 1e-9 && fabs(p.y - 10.0) < 1e-9 && p.z < 0.0 && p.z > -60.0);
}

static void the_surface_comes_through(void **state)
{
    struct fixture *f = *state;
    raise_relief(f);
    assert_true(build(f, rendered_head_mesh(f->model, f->shape, &f->pose)) > 0.97);
    const double places_mm[][2] = {{0, 0}, {-35, -22}, {40, 10}, {0, 45}, {-20, -60}};
    for (size_t i = 0; i < sizeof places_mm / sizeof places_mm[0]; i++) {
        double x = places_mm[i][0], y = places_mm[i][1], column, row;
        iso_face_patch_pixel(f->patch, x, y, &column, &row);
        int at = (int)lround(row) * f->side + (int)lround(column);
        struct iso_vec3 grid = iso_frame_point_at(iso_face_patch_frame(f->patch),
                                                  (int)lround(column), (int)lround(row));
        double forward = (double)f->mean[at] - grid.z;
        assert_true(fabs(forward - relief_mm(grid.x, -grid.y)) < 0.1);
    }
}

static void a_hole_is_filled_and_remembered(void **state)
{
    struct fixture *f = *state;
    raise_relief(f);
    double whole = build(f, rendered_head_mesh(f->model, f->shape, &f->pose));
    size_t bytes = (size_t)(f->side * f->side) * sizeof(float);
    float *truth = malloc(bytes);
    assert_non_null(truth);
    memcpy(truth, iso_face_patch_frame(f->patch)->depth_mm, bytes);

    struct iso_mesh *mesh = rendered_head_mesh(f->model, f->shape, &f->pose);
    cut_spot(f, mesh);
    double holed = build(f, mesh);
    const struct iso_frame *frame = iso_face_patch_frame(f->patch);
    for (int i = 0; i < f->side * f->side; i++) {
        assert_int_equal(frame->depth_mm[i] > 0.0f, truth[i] > 0.0f);
        assert_true(fabsf(frame->depth_mm[i] - truth[i]) < 0.3f);
    }
    free(truth);
    assert_true(iso_face_patch_measured(f->patch, cheek_x_mm, cheek_y_mm) == 0.0);
    assert_true(iso_face_patch_measured(f->patch, -cheek_x_mm, cheek_y_mm) == 1.0);
    assert_true(iso_face_patch_measured(f->patch, 0.0, 0.0) == 1.0);
    assert_true(iso_face_patch_measured(f->patch, 500.0, 0.0) == 0.0);
    /* The spot and the triangles that it touches have one to eight times its area. */
    double lost = (whole - holed) * 21000.0 / (M_PI * spot_mm * spot_mm);
    assert_true(lost > 1.0 && lost < 8.0);
}

static void measured_goes_over_smoothly(void **state)
{
    struct fixture *f = *state;
    struct iso_mesh *mesh = rendered_head_mesh(f->model, NULL, &f->pose);
    cut_spot(f, mesh);
    (void)build(f, mesh);
    int between = 0;
    double before = iso_face_patch_measured(f->patch, cheek_x_mm, cheek_y_mm);
    for (double x = cheek_x_mm; x < cheek_x_mm + 30.0; x += 0.25) {
        double measured = iso_face_patch_measured(f->patch, x, cheek_y_mm);
        assert_true(measured >= 0.0 && measured <= 1.0);
        assert_true(fabs(measured - before) <= 0.25 / usual.spacing_mm + 1e-9);
        between += measured > 0.0 && measured < 1.0;
        before = measured;
    }
    assert_true(before == 1.0 && between >= 3);
}

static void a_hand_before_the_cheek_is_no_face(void **state)
{
    struct fixture *f = *state;
    struct iso_mesh *mesh = rendered_head_mesh(f->model, NULL, &f->pose);
    for (int32_t i = 0; i < mesh->n_vertices; i++) {
        struct iso_vec3 p = f->shape[i];
        if (hypot(p.x - cheek_x_mm, p.y - cheek_y_mm) < 2.0 * spot_mm) {
            p.z += 25.0;
            mesh->vertices_mm[i] = iso_rigid_apply(&f->pose, p);
        }
    }
    double coverage = build(f, mesh);
    assert_true(coverage < 0.97 && coverage > 0.8);
    assert_true(iso_face_patch_measured(f->patch, cheek_x_mm, cheek_y_mm) == 0.0);
    double column, row;
    iso_face_patch_pixel(f->patch, cheek_x_mm, cheek_y_mm, &column, &row);
    float mean = f->mean[(int)lround(row) * f->side + (int)lround(column)];
    /* The hand moves the places between hand and face a little towards it. The hand itself has no
     * other effect. */
    assert_true(fabsf(depth_at(f, cheek_x_mm, cheek_y_mm) - mean) < 20.0f);
}

static void half_a_face_is_half_covered(void **state)
{
    struct fixture *f = *state;
    struct iso_mesh *mesh = rendered_head_mesh(f->model, NULL, &f->pose);
    int32_t kept = 0;
    for (int32_t t = 0; t < mesh->n_triangles; t++) {
        const int32_t *v = mesh->triangles[t];
        if (f->shape[v[0]].x + f->shape[v[1]].x + f->shape[v[2]].x > 0.0) {
            memmove(mesh->triangles[kept++], v, sizeof mesh->triangles[0]);
        }
    }
    mesh->n_triangles = kept;
    assert_true(fabs(build(f, mesh) - 0.5) < 0.03);
    assert_true(iso_face_patch_measured(f->patch, 40.0, 0.0) == 1.0);
    assert_true(iso_face_patch_measured(f->patch, -40.0, 0.0) == 0.0);
}

static void nothing_measured_is_the_mean_face(void **state)
{
    struct fixture *f = *state;
    struct iso_mesh *mesh = rendered_head_mesh(f->model, NULL, &f->pose);
    mesh->n_triangles = 0;
    assert_true(build(f, mesh) == 0.0);
    const struct iso_frame *frame = iso_face_patch_frame(f->patch);
    for (int i = 0; i < f->side * f->side; i++) {
        assert_true(frame->depth_mm[i] == 0.0f || frame->depth_mm[i] == f->mean[i]);
    }
    assert_true(iso_face_patch_measured(f->patch, 0.0, 0.0) == 0.0);
}

static void bad_patches_are_refused(void **state)
{
    struct fixture *f = *state;
    struct iso_face_patch_options bad[8];
    struct iso_face_patch *patch = NULL;
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        bad[i] = usual;
    }
    bad[0].radius_mm = 39.9;
    bad[1].radius_mm = 150.1;
    bad[2].spacing_mm = 0.49;
    bad[3].spacing_mm = 8.1;
    bad[4].smoothing_mm = -0.1;
    bad[5].smoothing_mm = 20.1;
    bad[6].outlier_mm = 0.0;
    bad[7].radius_mm = NAN;
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        assert_int_equal(iso_face_patch_new(f->model, &bad[i], &patch), -EINVAL);
        assert_null(patch);
    }
    const struct iso_face_patch_options widest = {150.0, 8.0, 0.0, 1.0},
                                        narrowest = {40, 0.5, 20, 1};
    assert_int_equal(iso_face_patch_new(f->model, &widest, &patch), 0);
    iso_face_patch_free(patch);
    assert_int_equal(iso_face_patch_new(f->model, &narrowest, &patch), 0);
    iso_face_patch_free(patch);
    iso_face_patch_free(NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(the_mean_face_has_no_residual, set_up, tear_down),
        cmocka_unit_test_setup_teardown(the_nose_tip_is_in_the_middle, set_up, tear_down),
        cmocka_unit_test_setup_teardown(the_surface_comes_through, set_up, tear_down),
        cmocka_unit_test_setup_teardown(a_hole_is_filled_and_remembered, set_up, tear_down),
        cmocka_unit_test_setup_teardown(measured_goes_over_smoothly, set_up, tear_down),
        cmocka_unit_test_setup_teardown(a_hand_before_the_cheek_is_no_face, set_up, tear_down),
        cmocka_unit_test_setup_teardown(half_a_face_is_half_covered, set_up, tear_down),
        cmocka_unit_test_setup_teardown(nothing_measured_is_the_mean_face, set_up, tear_down),
        cmocka_unit_test_setup_teardown(bad_patches_are_refused, set_up, tear_down),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
