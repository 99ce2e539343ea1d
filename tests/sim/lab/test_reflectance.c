/* The rest of an infrared image after the effects of lamp and shape are removed: a pattern on a
 * tilted plane, whose image is computed and not rendered. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "sim/lab/methods/reflectance.h"

enum { SIDE = 51 };
static const double spacing_mm = 3.0, tilt_rad = 0.5;

static const struct iso_camera camera = {
    .projection = ISO_PINHOLE,
    .width_px = 320,
    .height_px = 240,
    .fx_px = 400.0,
    .fy_px = 390.0,
    .cx_px = 150.0,
    .cy_px = 110.0,
};

/* The face's z points towards the camera, its y up. It is turned about y, 500 mm away. */
static struct iso_rigid pose(void)
{
    struct iso_mat3 front = {{{1, 0, 0}, {0, -1, 0}, {0, 0, -1}}};
    struct iso_mat3 turn = iso_mat3_rotation(iso_vec3(0.0, tilt_rad, 0.0));
    return (struct iso_rigid){iso_mat3_mul(&turn, &front), {10.0, -6.0, 500.0}};
}

/* The brightness of the plane z = 0 at a place of the face frame: a dark stripe on skin of one
 * tone. */
static double albedo(double x_mm)
{
    return fabs(x_mm - 12.0) < 6.0 ? 0.3 : 0.6;
}

static struct sim_scan *flat_face(void)
{
    struct sim_scan *face = NULL;
    assert_int_equal(sim_scan_new(SIDE, spacing_mm, &face), 0);
    for (int i = 0; i < SIDE * SIDE; i++) {
        face->z_mm[i] = 0.0f;
        face->measured[i] = 1;
    }
    return face;
}

/* The plane as the camera sees it, with a lamp at the camera that is `lamp` times as bright. */
static struct iso_frame *shoot(double lamp, bool stripe)
{
    struct iso_frame *frame = NULL;
    struct iso_rigid camera_from_face = pose(),
                     face_from_camera = iso_rigid_inverse(&camera_from_face);
    struct iso_vec3 normal = iso_mat3_apply(&camera_from_face.rotation, iso_vec3(0, 0, 1));
    assert_int_equal(iso_frame_new(&camera, camera.width_px, camera.height_px, true, &frame), 0);
    for (int i = 0; i < camera.width_px * camera.height_px; i++) {
        struct iso_vec3 sight = iso_camera_back_project(&camera, i % camera.width_px,
                                                        i / camera.width_px, 1.0);
        double z = iso_dot(normal, camera_from_face.translation_mm) / iso_dot(normal, sight);
        struct iso_vec3 p = iso_scale(z, sight);
        double range = iso_norm(p), cosine = -iso_dot(normal, p) / range;
        double x = iso_rigid_apply(&face_from_camera, p).x;
        frame->depth_mm[i] = (float)z;
        frame->intensity[i] = (float)(lamp * (stripe ? albedo(x) : 0.6) * cosine * 1e4 /
                                      (range * range));
    }
    return frame;
}

static double at(const struct sim_scan *face, int column, int row)
{
    return (double)face->reflectance[row * SIDE + column];
}

/* Seen at 29 degrees, the image of even skin changes by a third over the plane. The result shows
 * nothing of this, for any lamp. */
static void lamp_and_slant_are_taken_out(void **state)
{
    (void)state;
    struct iso_rigid camera_from_face = pose();
    for (int k = 0; k < 2; k++) {
        struct sim_scan *face = flat_face();
        struct iso_frame *frame = shoot(k ? 0.2 : 1.0, false);
        double worst = 0.0;
        assert_int_equal(sim_reflectance_measure(frame, &camera_from_face, face), 0);
        for (int i = 0; i < SIDE * SIDE; i++) {
            worst = fmax(worst, fabs((double)face->reflectance[i] - 1.0));
        }
        print_message("even skin: at most %.4f from 1\n", worst);
        assert_true(worst < 0.01);
        iso_frame_free(frame);
        sim_scan_free(face);
    }
}

static void a_dark_stripe_is_dark(void **state)
{
    (void)state;
    struct iso_rigid camera_from_face = pose();
    struct sim_scan *face = flat_face();
    struct iso_frame *frame = shoot(0.7, true);
    assert_int_equal(sim_reflectance_measure(frame, &camera_from_face, face), 0);
    int middle = SIDE / 2, stripe = middle + (int)lround(12.0 / spacing_mm);
    print_message("stripe %.3f, skin beside it %.3f, on the other side %.3f\n",
                  at(face, stripe, middle), at(face, stripe + 6, middle), at(face, 4, middle));
    assert_true(at(face, stripe, middle) < 0.75);
    assert_true(at(face, stripe + 6, middle) > 1.0);
    assert_true(fabs(at(face, 4, middle) - 1.0) < 0.02);
    assert_true(fabs(at(face, middle, stripe) - at(face, middle, middle)) < 0.02); /* not along y */
    iso_frame_free(frame);
    sim_scan_free(face);
}

/* A hand before the face, filled-in surface, and the edge of the grid have no known value: 1. */
static void places_that_are_not_seen_have_no_value(void **state)
{
    (void)state;
    struct iso_rigid camera_from_face = pose();
    struct sim_scan *face = flat_face();
    struct iso_frame *frame = shoot(1.0, true);
    for (int i = 0; i < camera.width_px * camera.height_px; i++) {
        frame->depth_mm[i] -= i % camera.width_px < 150 ? 60.0f : 0.0f;
    }
    int middle = SIDE / 2, stripe = middle + 4;
    face->measured[middle * SIDE + stripe] = 0;
    assert_int_equal(sim_reflectance_measure(frame, &camera_from_face, face), 0);
    assert_float_equal(at(face, 4, middle), 1.0, 0.0);
    assert_float_equal(at(face, stripe, middle), 1.0, 0.0);
    assert_true(at(face, stripe, middle + 3) < 0.75);
    assert_float_equal(at(face, 0, 0), 1.0, 0.0);
    iso_frame_free(frame);
    sim_scan_free(face);
}

static void without_an_image_there_is_none(void **state)
{
    (void)state;
    struct iso_rigid camera_from_face = pose();
    struct sim_scan *face = flat_face();
    struct iso_frame *frame = shoot(1.0, true);
    float *image = frame->intensity;
    frame->intensity = NULL;
    assert_int_equal(sim_reflectance_measure(frame, &camera_from_face, face), 0);
    assert_null(face->reflectance);
    frame->intensity = image;
    iso_frame_free(frame);
    sim_scan_free(face);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(lamp_and_slant_are_taken_out),
        cmocka_unit_test(a_dark_stripe_is_dark),
        cmocka_unit_test(places_that_are_not_seen_have_no_value),
        cmocka_unit_test(without_an_image_there_is_none),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
