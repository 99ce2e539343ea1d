/* The back end v4l2-stereo with simulated cameras: pixel formats, cameras with and without a common
 * trigger, and refusals. The frames have the depths of a wall with known disparity; test_stereo
 * covers the quality of the matching. */
#include <errno.h>
#include <linux/videodev2.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "drivers/sensor/v4l2/sensor_v4l2_stereo.h"
#include "tests/drivers/sensor/fake_v4l2.h"
#include "tests/support/devices/manual_clock.h"
#include "tests/support/devices/stereo_wall.h"
#include "tests/support/scratch.h"

#define MS INT64_C(1000000)

enum { WIDTH = WALL_WIDTH, HEIGHT = WALL_HEIGHT, DISPARITY = 40 };

static int64_t now_ns = INT64_C(5000) * 1000 * MS;
static struct fake_v4l2 fake;
static struct iso_v4l2_system fake_system;
static void *scratch;

static int open_fake(const struct iso_option *options, size_t n_options,
                     const struct iso_clock *clock, void **self, struct iso_fault *fault)
{
    return iso_sensor_v4l2_stereo_open_on(&fake_system, options, n_options, clock, self, fault);
}

static int set_up(void **state)
{
    memset(&fake, 0, sizeof fake);
    for (int i = 0; i < FAKE_CAMERAS; i++) {
        fake.cameras[i] = (struct fake_camera){
            .path = i == 0 ? "/dev/left" : "/dev/right",
            .format = V4L2_PIX_FMT_GREY,
            .width_px = WIDTH,
            .height_px = HEIGHT,
            .stride_bytes = WIDTH + 16,
            .capabilities = V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_STREAMING,
        };
    }
    fake.now_ns = 90 * 1000 * MS;
    fake_system = fake_v4l2_system(&fake);
    int failed = scratch_setup(state);
    scratch = *state;
    stereo_wall_write_rig(scratch_path(scratch, "rig.ini"));
    return failed;
}

static int tear_down(void **state)
{
    fake_v4l2_assert_released(&fake);
    return scratch_teardown(state);
}

static void use_format(uint32_t format)
{
    for (int i = 0; i < FAKE_CAMERAS; i++) {
        fake.cameras[i].format = format;
        fake.cameras[i].stride_bytes = WIDTH * (format == V4L2_PIX_FMT_GREY ? 1 : 2) + 16;
    }
}

static int open_sensor(const char *pair_ms, struct iso_sensor **sensor, struct iso_fault *fault)
{
    static struct iso_sensor_ops ops;
    struct iso_clock clock = manual_clock(&now_ns);
    struct iso_option options[] = {{"left", "/dev/left"},
                                   {"right", "/dev/right"},
                                   {"calibration", scratch_path(scratch, "rig.ini")},
                                   {"near_mm", "400"},
                                   {"far_mm", "2000"},
                                   {"pair_ms", pair_ms}};
    ops = iso_sensor_v4l2_stereo_ops;
    ops.open = open_fake;
    return iso_sensor_open_ops(&ops, options, 6, &clock, sensor, fault);
}

/* Returns a 16-bit pixel with 8 significant bits. The other bits are not 0. */
static unsigned word_of(uint32_t format, unsigned grey)
{
    switch (format) {
    case V4L2_PIX_FMT_Y16:
        return grey << 8 | 0x7f;
    case V4L2_PIX_FMT_Y12:
        return grey << 4 | 0x3;
    case V4L2_PIX_FMT_Y10:
        return grey << 2 | 0x1;
    case V4L2_PIX_FMT_YUYV:
        return grey | 0x8000;
    default:
        return grey << 8 | 0x80;
    }
}

static void put(uint32_t format, uint8_t *pixels, size_t i, double value)
{
    unsigned grey = (unsigned)value;
    if (format == V4L2_PIX_FMT_GREY) {
        pixels[i] = (uint8_t)grey;
        return;
    }
    const unsigned word = word_of(format, grey);
    pixels[2 * i] = (uint8_t)word;
    pixels[2 * i + 1] = (uint8_t)(word >> 8);
}

static void shoot(int eye, int64_t stamp_ms, enum fake_fate fate)
{
    static uint8_t pixels[2 * WIDTH * HEIGHT];
    for (int i = 0; i < WIDTH * HEIGHT; i++) {
        int x = i % WIDTH + (eye == 0 ? 0 : DISPARITY);
        put(fake.cameras[eye].format, pixels, (size_t)i, stereo_wall_level(x, i / WIDTH));
    }
    fake_shoot(&fake.cameras[eye], fake.now_ns - 100 * MS + stamp_ms * MS, pixels, fate);
}

static int look(struct iso_sensor *sensor, const struct iso_frame **frame)
{
    return iso_sensor_wait(sensor, now_ns, frame, NULL);
}

static void every_grey_format_is_read(void **state)
{
    (void)state;
    static const uint32_t formats[] = {V4L2_PIX_FMT_GREY, V4L2_PIX_FMT_Y16,  V4L2_PIX_FMT_Y12,
                                       V4L2_PIX_FMT_Y10,  V4L2_PIX_FMT_YUYV, V4L2_PIX_FMT_UYVY};
    for (size_t f = 0; f < sizeof formats / sizeof *formats; f++) {
        struct iso_sensor *sensor = NULL;
        const struct iso_frame *frame = NULL;
        int n = 0, wrong = 0;
        use_format(formats[f]);
        assert_int_equal(open_sensor("4", &sensor, NULL), 0);
        assert_int_equal(iso_sensor_start(sensor, NULL), 0);
        shoot(0, 0, FAKE_GOOD);
        shoot(1, 1, FAKE_GOOD);
        assert_int_equal(look(sensor, &frame), 0);
        for (int row = 10; row < HEIGHT - 10; row++) {
            for (int column = 70; column < WIDTH - 10; column++, n++) {
                double z_mm = (double)iso_frame_depth_at(frame, column, row);
                size_t i = (size_t)row * WIDTH + (size_t)column;
                wrong += !(fabs(z_mm - (double)WALL_FOCAL_PX * WALL_BASELINE_MM / DISPARITY) < 1.0);
                unsigned grey = (unsigned)stereo_wall_level(column, row);
                assert_true(fabsf(frame->intensity[i] * 255.0f - (float)grey) < 1.01f);
            }
        }
        print_message("format %.4s: %d of %d depths off by 1 mm or missing\n",
                      (const char *)&formats[f], wrong, n);
        assert_true(wrong < n / 100);
        assert_int_equal(frame->t_ns, now_ns - 100 * MS);
        iso_sensor_close(sensor);
    }
}

/* The cameras run without a common trigger, 12 ms apart. */
static void cameras_without_a_trigger_need_patience(void **state)
{
    (void)state;
    static const char *const patience[] = {"4", "17"};
    for (int k = 0; k < 2; k++) {
        struct iso_sensor *sensor = NULL;
        const struct iso_frame *frame = NULL;
        int frames = 0;
        assert_int_equal(open_sensor(patience[k], &sensor, NULL), 0);
        assert_int_equal(iso_sensor_start(sensor, NULL), 0);
        for (int i = 0; i < 3; i++) {
            shoot(0, 33 * i, FAKE_GOOD);
            frames += look(sensor, &frame) == 0;
            shoot(1, 33 * i + 12, FAKE_GOOD);
            frames += look(sensor, &frame) == 0;
        }
        assert_int_equal(frames, k == 0 ? 0 : 3);
        assert_int_equal(iso_sensor_health(sensor).lost, 0);
        iso_sensor_close(sensor);
    }
}

static void a_lost_right_picture_is_a_gap(void **state)
{
    (void)state;
    struct iso_sensor *sensor = NULL;
    const struct iso_frame *frame = NULL;
    assert_int_equal(open_sensor("4", &sensor, NULL), 0);
    assert_int_equal(iso_sensor_start(sensor, NULL), 0);
    for (int i = 0; i < 3; i++) {
        shoot(0, 33 * i, FAKE_GOOD);
        shoot(1, 33 * i + 1, i == 1 ? FAKE_LOST : FAKE_GOOD);
        assert_int_equal(look(sensor, &frame), i == 1 ? -ETIMEDOUT : 0);
    }
    assert_int_equal(frame->sequence, 2);
    assert_int_equal(iso_sensor_health(sensor).lost, 1);
    fake_unplug(&fake.cameras[1]);
    assert_int_equal(look(sensor, &frame), -ENODEV);
    fake.cameras[1].streaming = false; /* unplugging has ended the stream */
    iso_sensor_close(sensor);
}

/* The class does not see the sequence numbers of the right camera. This test shows that an old
 * picture does not become part of a pair. */
static void a_late_right_picture_has_no_part_in_a_pair(void **state)
{
    (void)state;
    struct iso_sensor *sensor = NULL;
    const struct iso_frame *frame = NULL;
    assert_int_equal(open_sensor("4", &sensor, NULL), 0);
    assert_int_equal(iso_sensor_start(sensor, NULL), 0);
    shoot(0, 0, FAKE_GOOD);
    fake.cameras[1].sequence = 7;
    shoot(1, 1, FAKE_GOOD);
    assert_int_equal(look(sensor, &frame), 0);
    shoot(0, 33, FAKE_GOOD);
    fake.cameras[1].sequence = 6;
    shoot(1, 34, FAKE_GOOD);
    assert_int_equal(look(sensor, &frame), -EBADMSG);
    assert_int_equal(look(sensor, &frame), -ETIMEDOUT);
    fake.cameras[1].sequence = 9;
    shoot(0, 66, FAKE_GOOD);
    shoot(1, 67, FAKE_GOOD);
    assert_int_equal(look(sensor, &frame), 0);
    assert_int_equal(frame->sequence, 2);
    assert_int_equal(iso_sensor_health(sensor).lost, 1);
    assert_int_equal(iso_sensor_health(sensor).device.dropped,
                     2); /* the late picture and the left one of its pair */
    iso_sensor_close(sensor);
}

static void describes_itself(void **state)
{
    (void)state;
    struct iso_sensor *sensor = NULL;
    struct iso_sensor_description description;
    assert_int_equal(open_sensor("4", &sensor, NULL), 0);
    assert_int_equal(iso_sensor_describe(sensor, &description), 0);
    assert_string_equal(description.model, "stereo");
    assert_string_equal(description.serial, "fake:/dev/left");
    assert_true(description.intensity);
    assert_int_equal(description.width_px, WIDTH);
    assert_int_equal(description.height_px, HEIGHT);
    iso_sensor_close(sensor);
}

static void refuses_bad_options(void **state)
{
    (void)state;
    struct iso_sensor *sensor = NULL;
    struct iso_fault fault = {.text = ""};
    assert_int_equal(open_sensor("soon", &sensor, &fault), -EINVAL);
    assert_string_equal(fault.text, "sensor v4l2-stereo: bad value 'soon' for 'pair_ms' "
                                    "(a number, 0.1 to 1000)");
    scratch_write_text(scratch_path(scratch, "rig.ini"), "[left]\nwidth_px = 3\n");
    assert_int_equal(open_sensor("4", &sensor, &fault), -EINVAL);
    assert_non_null(strstr(fault.text, "rig.ini: format is missing from [stereo]"));
    assert_null(sensor);
}

#define ON_FAKE(test) cmocka_unit_test_setup_teardown(test, set_up, tear_down)

int main(void)
{
    const struct CMUnitTest tests[] = {
        ON_FAKE(every_grey_format_is_read),
        ON_FAKE(cameras_without_a_trigger_need_patience),
        ON_FAKE(a_lost_right_picture_is_a_gap),
        ON_FAKE(a_late_right_picture_has_no_part_in_a_pair),
        ON_FAKE(describes_itself),
        ON_FAKE(refuses_bad_options),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
