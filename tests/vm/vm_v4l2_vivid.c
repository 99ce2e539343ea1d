/* The back end v4l2-stereo on two cameras of the kernel's test driver (vivid): frames, stop and
 * start, damage, gaps, a stream that breaks, a cable that is unplugged. */
#include <errno.h>
#include <fcntl.h>
#include <linux/videodev2.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <time.h>
#include <unistd.h>

#include <cmocka.h>

#include "drivers/sensor/contract/sensor.h"
#include "drivers/stereo/calibration.h"

enum { WIDTH = 320, HEIGHT = 180 };

#define SECOND INT64_C(1000000000)

static int64_t monotonic_ns(void *context)
{
    struct timespec now;
    (void)context;
    (void)clock_gettime(CLOCK_MONOTONIC, &now);
    return now.tv_sec * SECOND + now.tv_nsec;
}

static const struct iso_clock clock_of_kernel = {monotonic_ns, NULL};

static void write_calibration(void)
{
    struct iso_camera camera = {.projection = ISO_PINHOLE,
                                .width_px = WIDTH,
                                .height_px = HEIGHT,
                                .fx_px = 300.0,
                                .fy_px = 300.0,
                                .cx_px = 0.5 * (WIDTH - 1),
                                .cy_px = 0.5 * (HEIGHT - 1)};
    struct iso_stereo_calibration calibration = {
        .camera = {camera, camera}, .right_from_left = {iso_mat3_identity(), {-60.0, 0.0, 0.0}}};
    assert_int_equal(iso_stereo_calibration_write("rig.ini", &calibration, NULL), 0);
}

/* The cameras are not synchronised, so pictures of a pair may be half a period apart. */
static struct iso_sensor *opened(void)
{
    const struct iso_option options[] = {{"left", "/dev/video0"},    {"right", "/dev/video1"},
                                         {"calibration", "rig.ini"}, {"pair_ms", "60"},
                                         {"near_mm", "400"},         {"far_mm", "1000"}};
    struct iso_sensor *sensor = NULL;
    struct iso_fault fault = {.text = ""};
    int error = iso_sensor_open("v4l2-stereo", options, 6, &clock_of_kernel, &sensor, &fault);
    assert_string_equal(fault.text, "");
    assert_int_equal(error, 0);
    return sensor;
}

/* Waits for the next frame. The time is long because on a busy host vivid skips pictures of one
 * camera, and pairs are rare. */
static int next(struct iso_sensor *sensor, const struct iso_frame **frame, struct iso_fault *fault)
{
    return iso_sensor_wait(sensor, monotonic_ns(NULL) + 200 * SECOND, frame, fault);
}

static void expect_frame(struct iso_sensor *sensor)
{
    const struct iso_frame *frame = NULL;
    assert_int_equal(next(sensor, &frame, NULL), 0);
}

/* Opens and starts the sensor and waits for its first frame. */
static struct iso_sensor *streaming(void)
{
    struct iso_sensor *sensor = opened();
    assert_int_equal(iso_sensor_start(sensor, NULL), 0);
    expect_frame(sensor);
    return sensor;
}

/* The sensor fails as expected, after at most a few frames that were already on their way. */
static void expect_failure(struct iso_sensor *sensor, int expected, const char *words)
{
    const struct iso_frame *frame = NULL;
    struct iso_fault fault = {.text = ""};
    int error = 0;
    for (int i = 0; !error && i < 20; i++) {
        error = next(sensor, &frame, &fault);
    }
    assert_int_equal(error, expected);
    assert_non_null(strstr(fault.text, words));
}

/* Sets a control of a camera by its name. */
static void set_control(const char *path, const char *name, int value)
{
    struct v4l2_query_ext_ctrl query = {.id = V4L2_CTRL_FLAG_NEXT_CTRL};
    int fd = open(path, O_RDWR | O_CLOEXEC);
    assert_true(fd >= 0);
    while (ioctl(fd, VIDIOC_QUERY_EXT_CTRL, &query) == 0 && strcmp(query.name, name) != 0) {
        query.id |= V4L2_CTRL_FLAG_NEXT_CTRL;
    }
    if (strcmp(query.name, name) != 0) {
        fail_msg("%s has no control '%s'", path, name);
    }
    struct v4l2_control control = {.id = query.id, .value = value};
    assert_int_equal(ioctl(fd, VIDIOC_S_CTRL, &control), 0);
    (void)close(fd);
}

static void frames_come_in_order(void **state)
{
    (void)state;
    struct iso_sensor *sensor = opened();
    const struct iso_frame *frame = NULL;
    for (int round = 0; round < 2; round++) {
        uint64_t sequence = 0;
        int64_t t_ns = 0;
        struct iso_fault fault = {.text = ""};
        int error = iso_sensor_start(sensor, &fault);
        assert_string_equal(fault.text, "");
        assert_int_equal(error, 0);
        for (int i = 0; i < 5; i++) {
            struct iso_fault flaw = {.text = ""};
            assert_int_equal(next(sensor, &frame, NULL), 0);
            assert_int_equal(iso_frame_check(frame, &flaw), 0);
            assert_int_equal(frame->width_px, WIDTH);
            assert_int_equal(frame->height_px, HEIGHT);
            assert_true(i == 0 || (frame->sequence > sequence && frame->t_ns > t_ns));
            /* The frame was taken during the last 60 seconds, by the clock that the sensor got. */
            assert_true(frame->t_ns <= monotonic_ns(NULL));
            assert_true(frame->t_ns > monotonic_ns(NULL) - 60 * SECOND);
            float brightest = 0.0f, darkest = 1.0f;
            for (int k = 0; k < WIDTH * HEIGHT; k++) {
                brightest = frame->intensity[k] > brightest ? frame->intensity[k] : brightest;
                darkest = frame->intensity[k] < darkest ? frame->intensity[k] : darkest;
            }
            assert_true(brightest > 0.6f && darkest < 0.1f); /* the bars of the test picture */
            sequence = frame->sequence;
            t_ns = frame->t_ns;
        }
        assert_int_equal(iso_sensor_stop(sensor, NULL), 0);
    }
    struct iso_sensor_description description;
    assert_int_equal(iso_sensor_describe(sensor, &description), 0);
    print_message("%s\n", description.serial);
    assert_non_null(strstr(description.serial, "vivid-000"));
    iso_sensor_close(sensor);
}

static void one_camera_serves_one_sensor(void **state)
{
    (void)state;
    struct iso_sensor *first = opened(), *second = opened();
    struct iso_fault fault = {.text = ""};
    assert_int_equal(iso_sensor_start(first, NULL), 0);
    assert_int_equal(iso_sensor_start(second, &fault), -EBUSY);
    assert_non_null(strstr(fault.text, "/dev/video0: does not stream: Device or resource busy"));
    iso_sensor_close(first);
    assert_int_equal(iso_sensor_start(second, NULL), 0);
    iso_sensor_close(second);
}

static void a_damaged_picture_is_reported_and_the_next_is_good(void **state)
{
    (void)state;
    struct iso_sensor *sensor = streaming();
    set_control("/dev/video1", "Inject V4L2_BUF_FLAG_ERROR", 1);
    expect_failure(sensor, -EBADMSG, "/dev/video1: picture");
    expect_frame(sensor);
    iso_sensor_close(sensor);
}

static void dropped_pictures_are_gaps(void **state)
{
    (void)state;
    struct iso_sensor *sensor = opened();
    const struct iso_frame *frame = NULL;
    set_control("/dev/video1", "Percentage of Dropped Buffers", 50);
    assert_int_equal(iso_sensor_start(sensor, NULL), 0);
    for (int i = 0; i < 12; i++) {
        assert_int_equal(next(sensor, &frame, NULL), 0);
    }
    print_message("12 frames, %llu lost\n", (unsigned long long)iso_sensor_health(sensor).lost);
    assert_true(iso_sensor_health(sensor).lost > 0);
    set_control("/dev/video1", "Percentage of Dropped Buffers", 0);
    iso_sensor_close(sensor);
}

static void a_stream_that_breaks_is_started_again(void **state)
{
    (void)state;
    struct iso_sensor *sensor = streaming();
    set_control("/dev/video0", "Inject Fatal Streaming Error", 1);
    expect_failure(sensor, -EIO, "/dev/video0: the stream broke");
    assert_int_equal(iso_sensor_stop(sensor, NULL), 0);
    assert_int_equal(iso_sensor_start(sensor, NULL), 0);
    expect_frame(sensor);
    iso_sensor_close(sensor);
}

/* This test is the last one, because the device does not come back. */
static void a_pulled_cable_is_a_lost_device(void **state)
{
    (void)state;
    struct iso_sensor *sensor = streaming();
    set_control("/dev/video1", "Disconnect", 1);
    expect_failure(sensor, -ENODEV, "/dev/video1: the device is gone");
    assert_int_equal(iso_sensor_health(sensor).state, ISO_SENSOR_LOST);
    iso_sensor_close(sensor);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(frames_come_in_order),
        cmocka_unit_test(one_camera_serves_one_sensor),
        cmocka_unit_test(a_damaged_picture_is_reported_and_the_next_is_good),
        cmocka_unit_test(dropped_pictures_are_gaps),
        cmocka_unit_test(a_stream_that_breaks_is_started_again),
        cmocka_unit_test(a_pulled_cable_is_a_lost_device),
    };
    write_calibration();
    return cmocka_run_group_tests(tests, NULL, NULL);
}
