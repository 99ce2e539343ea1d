/* Converts OpenNI2's frames to ours: units, mirroring, crops, rows with padding, and frames with
 * wrong sizes. */
#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "drivers/sensor/openni2/openni2_frame.h"

enum { WIDTH = 4, HEIGHT = 3 };

/* Sample (column, row) is 100 * row + column + 1. A row has one sample of padding. */
static uint16_t samples[HEIGHT][WIDTH + 1];

static OniFrame frame_of(OniPixelFormat format)
{
    for (int row = 0; row < HEIGHT; row++) {
        for (int column = 0; column < WIDTH; column++) {
            samples[row][column] = (uint16_t)(100 * row + column + 1);
        }
        samples[row][WIDTH] = 9999;
    }
    return (OniFrame){
        .data = samples,
        .dataSize = sizeof samples,
        .width = WIDTH,
        .height = HEIGHT,
        .stride = sizeof samples[0],
        .videoMode = {.pixelFormat = format},
    };
}

static int setup(void **state)
{
    const struct iso_camera camera = iso__openni2_camera(WIDTH, HEIGHT, 0.1, 0.08);
    return iso_frame_new(&camera, WIDTH, HEIGHT, true, (struct iso_frame **)state);
}

static int teardown(void **state)
{
    iso_frame_free(*state);
    return 0;
}

static void reads_both_units(void **state)
{
    struct iso_frame *frame = *state;
    struct iso_fault what = {.text = ""};
    OniFrame in = frame_of(ONI_PIXEL_FORMAT_DEPTH_1_MM);
    assert_int_equal(iso__openni2_read_depth(&in, false, frame, &what), 0);
    assert_true(iso_frame_depth_at(frame, 3, 2) == 204.0F);
    assert_true(iso_frame_depth_at(frame, 0, 1) == 101.0F);
    in = frame_of(ONI_PIXEL_FORMAT_DEPTH_100_UM);
    assert_int_equal(iso__openni2_read_depth(&in, false, frame, &what), 0);
    assert_true(iso_frame_depth_at(frame, 3, 2) == 20.4F);
    assert_true(iso_frame_depth_at(frame, 1, 0) == 0.2F);
}

static void undoes_mirroring(void **state)
{
    struct iso_frame *frame = *state;
    struct iso_fault what = {.text = ""};
    OniFrame in = frame_of(ONI_PIXEL_FORMAT_DEPTH_1_MM);
    assert_int_equal(iso__openni2_read_depth(&in, true, frame, &what), 0);
    assert_true(iso_frame_depth_at(frame, 0, 2) == 204.0F);
    assert_true(iso_frame_depth_at(frame, 3, 1) == 101.0F);
}

/* A crop of 2 x 2 at (0, 1). The frame has the position of the crop in the image that is not
 * mirrored. */
static void keeps_a_crop(void **state)
{
    struct iso_frame *frame = *state;
    struct iso_fault what = {.text = ""};
    for (int mirrored = 0; mirrored < 2; mirrored++) {
        OniFrame in = frame_of(ONI_PIXEL_FORMAT_DEPTH_1_MM);
        in.width = 2;
        in.height = 2;
        in.croppingEnabled = TRUE;
        in.cropOriginX = 0;
        in.cropOriginY = 1;
        assert_int_equal(iso__openni2_read_depth(&in, mirrored != 0, frame, &what), 0);
        assert_int_equal(frame->width_px, 2);
        assert_int_equal(frame->height_px, 2);
        assert_int_equal(frame->crop_x_px, mirrored ? 2 : 0);
        assert_int_equal(frame->crop_y_px, 1);
        assert_true(iso_frame_depth_at(frame, mirrored ? 1 : 0, 1) == 101.0F);
        assert_true(iso_frame_depth_at(frame, mirrored ? 0 : 1, 1) == 102.0F);
        assert_int_equal(iso_frame_check(frame, &what), 0);
    }
}

static void reads_intensities(void **state)
{
    struct iso_frame *frame = *state;
    struct iso_fault what = {.text = ""};
    static uint8_t colours[HEIGHT][WIDTH][3];
    OniFrame depth = frame_of(ONI_PIXEL_FORMAT_DEPTH_1_MM);
    OniFrame in = frame_of(ONI_PIXEL_FORMAT_GRAY16);
    assert_int_equal(iso__openni2_read_depth(&depth, false, frame, &what), 0);
    assert_int_equal(iso__openni2_read_intensity(&in, true, 204.0, frame, &what), 0);
    assert_true(frame->intensity[2 * WIDTH + 0] == 1.0F);
    assert_true(frame->intensity[2 * WIDTH + 3] == (float)(201.0 / 204.0));
    assert_int_equal(iso__openni2_read_intensity(&in, false, 100.0, frame, &what), 0);
    assert_true(frame->intensity[2 * WIDTH] == 1.0F); /* beyond full scale */
    colours[1][2][1] = 255;
    in.data = colours;
    in.dataSize = sizeof colours;
    in.stride = sizeof colours[0];
    in.videoMode.pixelFormat = ONI_PIXEL_FORMAT_RGB888;
    assert_int_equal(iso__openni2_read_intensity(&in, false, 255.0, frame, &what), 0);
    assert_true(fabs((double)frame->intensity[1 * WIDTH + 2] - 0.7152) < 1e-6);
    assert_true(frame->intensity[1 * WIDTH + 1] == 0.0F);
}

static void refuses(struct iso_frame *frame, const OniFrame *in, const char *expected)
{
    struct iso_fault what = {.text = ""};
    assert_int_equal(iso__openni2_read_depth(in, false, frame, &what), -EBADMSG);
    assert_string_equal(what.text, expected);
}

static void refuses_inconsistent_frames(void **state)
{
    const OniFrame good = frame_of(ONI_PIXEL_FORMAT_DEPTH_1_MM);
    OniFrame in = good;
    in.videoMode.pixelFormat = ONI_PIXEL_FORMAT_GRAY16;
    refuses(*state, &in, "is not of a depth format");
    in = good;
    in.width = WIDTH + 1;
    refuses(*state, &in, "is not within the image");
    in = good;
    in.croppingEnabled = TRUE;
    in.cropOriginY = 1;
    refuses(*state, &in, "is not within the image");
    in = good;
    in.height = 0;
    refuses(*state, &in, "is not within the image");
    in = good;
    in.stride = 2 * WIDTH - 1;
    refuses(*state, &in, "has rows shorter than its width");
    in = good;
    in.dataSize = (int)sizeof samples - 3; /* one byte of the last row is missing */
    refuses(*state, &in, "is truncated");
    in = good;
    in.dataSize = -1;
    refuses(*state, &in, "is truncated");
    in = good;
    in.data = NULL;
    refuses(*state, &in, "is truncated");
}

static void refuses_an_intensity_of_other_pixels(void **state)
{
    struct iso_fault what = {.text = ""};
    const OniFrame depth = frame_of(ONI_PIXEL_FORMAT_DEPTH_1_MM);
    OniFrame in = frame_of(ONI_PIXEL_FORMAT_GRAY16);
    assert_int_equal(iso__openni2_read_depth(&depth, false, *state, &what), 0);
    in.width = WIDTH - 1;
    assert_int_equal(iso__openni2_read_intensity(&in, false, 1.0, *state, &what), -EBADMSG);
    assert_string_equal(what.text, "does not cover the depths");
    in.videoMode.pixelFormat = ONI_PIXEL_FORMAT_JPEG;
    assert_int_equal(iso__openni2_read_intensity(&in, false, 1.0, *state, &what), -EBADMSG);
    assert_string_equal(what.text, "is not of a grey or colour format");
}

/* The field of view is the angle between the outer edges of the outer pixels. */
static void a_field_of_view_is_a_camera(void **state)
{
    const struct iso_camera camera = iso__openni2_camera(640, 480, 1.0226, 0.7966);
    struct iso_fault what = {.text = ""};
    double u = 0, v = 0;
    (void)state;
    assert_int_equal(iso_camera_check(&camera, &what), 0);
    const struct iso_vec3 corner = {tan(1.0226 / 2) * 1000, tan(0.7966 / 2) * 1000, 1000};
    assert_true(iso_camera_project(&camera, corner, &u, &v));
    assert_true(fabs(u - 639.5) < 1e-9);
    assert_true(fabs(v - 479.5) < 1e-9);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(reads_both_units, setup, teardown),
        cmocka_unit_test_setup_teardown(undoes_mirroring, setup, teardown),
        cmocka_unit_test_setup_teardown(keeps_a_crop, setup, teardown),
        cmocka_unit_test_setup_teardown(reads_intensities, setup, teardown),
        cmocka_unit_test_setup_teardown(refuses_inconsistent_frames, setup, teardown),
        cmocka_unit_test_setup_teardown(refuses_an_intensity_of_other_pixels, setup, teardown),
        cmocka_unit_test(a_field_of_view_is_a_camera),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
