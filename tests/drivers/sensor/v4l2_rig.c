#include "tests/drivers/sensor/v4l2_rig.h"

#include <linux/videodev2.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "drivers/sensor/v4l2/sensor_v4l2.h"
#include "tests/support/devices/manual_clock.h"
#include "tests/support/scratch.h"

#define MS INT64_C(1000000)

enum { WIDTH = 70, HEIGHT = 48 };

/* The injected clock and the kernel's clock differ, and both advance. */
int64_t v4l2_now_ns;
struct fake_v4l2 v4l2_fake;
static struct iso_v4l2_system fake_system;
void *v4l2_scratch;

void v4l2_at(int64_t ms)
{
    v4l2_now_ns = INT64_C(5000) * 1000 * MS + ms * MS;
    v4l2_fake.now_ns = INT64_C(77) * 1000 * MS + ms * MS;
}

static int64_t stamp(int64_t ms)
{
    return INT64_C(77) * 1000 * MS + ms * MS;
}

/* The back end on v4l2_fake, behind the wrapper of the class. */
static int open_fake(const struct iso_option *options, size_t n_options,
                     const struct iso_clock *clock, void **self, struct iso_fault *fault)
{
    return iso_sensor_v4l2_open_on(&fake_system, options, n_options, clock, self, fault);
}

const char v4l2_camera_ini[] = "[recording]\nformat = 1\nsensor = d435\n\n[depth]\n"
                               "projection = pinhole\nwidth_px = 70\nheight_px = 48\n"
                               "fx_px = 60.5\nfy_px = 61\ncx_px = 34\ncy_px = 24\nunit_mm = 0.5\n";

int v4l2_set_up(void **state)
{
    memset(&v4l2_fake, 0, sizeof v4l2_fake);
    for (int i = 0; i < FAKE_CAMERAS; i++) {
        v4l2_fake.cameras[i] = (struct fake_camera){
            .path = i == 0 ? "/dev/depth" : "/dev/ir",
            .format = i == 0 ? V4L2_PIX_FMT_Z16 : V4L2_PIX_FMT_GREY,
            .width_px = WIDTH,
            .height_px = HEIGHT,
            .stride_bytes = i == 0 ? 2 * WIDTH + 12 : WIDTH + 6,
            .capabilities = V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_STREAMING,
            .sequence = i == 0 ? 40 : 7,
        };
    }
    fake_system = fake_v4l2_system(&v4l2_fake);
    v4l2_at(0);
    int failed = scratch_setup(state);
    v4l2_scratch = *state;
    scratch_write_text(scratch_path(v4l2_scratch, "camera.ini"), v4l2_camera_ini);
    return failed;
}

int v4l2_tear_down(void **state)
{
    fake_v4l2_assert_released(&v4l2_fake);
    return scratch_teardown(state);
}

int v4l2_open_sensor(bool with_ir, struct iso_sensor **sensor, struct iso_fault *fault)
{
    struct iso_sensor_ops ops = iso_sensor_v4l2_ops;
    static struct iso_sensor_ops kept; /* the sensor keeps a pointer to it */
    struct iso_clock clock = manual_clock(&v4l2_now_ns);
    struct iso_option options[] = {{"device", "/dev/depth"},
                                   {"camera", scratch_path(v4l2_scratch, "camera.ini")},
                                   {"ir_device", "/dev/ir"}};
    ops.open = open_fake;
    kept = ops;
    return iso_sensor_open_ops(&kept, options, with_ir ? 3 : 2, &clock, sensor, fault);
}

struct iso_sensor *v4l2_started(bool with_ir)
{
    struct iso_sensor *sensor = NULL;
    struct iso_fault fault = {.text = ""};
    assert_int_equal(v4l2_open_sensor(with_ir, &sensor, &fault), 0);
    assert_int_equal(iso_sensor_start(sensor, &fault), 0);
    return sensor;
}

static uint16_t depth_count(int picture, int i)
{
    return (uint16_t)(i % 7 == 0 ? 0 : 900 + 31 * picture + i);
}

void v4l2_shoot_depth(int picture, int64_t ms, enum fake_fate fate)
{
    static uint16_t counts[WIDTH * HEIGHT];
    for (int i = 0; i < WIDTH * HEIGHT; i++) {
        counts[i] = depth_count(picture, i);
    }
    fake_shoot(&v4l2_fake.cameras[0], stamp(ms), counts, fate);
}

void v4l2_shoot_ir(int picture, int64_t ms, enum fake_fate fate)
{
    static uint8_t grey[WIDTH * HEIGHT];
    for (int i = 0; i < WIDTH * HEIGHT; i++) {
        grey[i] = (uint8_t)(3 * i + picture);
    }
    fake_shoot(&v4l2_fake.cameras[1], stamp(ms), grey, fate);
}

void v4l2_assert_frame(const struct iso_frame *frame, int picture, int64_t ms)
{
    for (int i = 0; i < WIDTH * HEIGHT; i++) {
        assert_true(frame->depth_mm[i] == 0.5f * (float)depth_count(picture, i));
        if (frame->intensity) {
            assert_true(frame->intensity[i] == (float)(uint8_t)(3 * i + picture) / 255.0f);
        }
    }
    /* The picture has the same age on the injected clock and on the kernel's clock. */
    assert_int_equal(frame->t_ns, INT64_C(5000) * 1000 * MS + ms * MS);
    assert_true(frame->camera.fx_px == 60.5 && frame->camera.fy_px == 61.0);
}

/* Fetches a frame without waiting: the deadline is now. */
int v4l2_look(struct iso_sensor *sensor, const struct iso_frame **frame, struct iso_fault *fault)
{
    return iso_sensor_wait(sensor, v4l2_now_ns, frame, fault);
}
