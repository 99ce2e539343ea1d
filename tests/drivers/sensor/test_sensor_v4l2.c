/* The back end v4l2 with simulated cameras (fake_v4l2): times, gaps, damage, loss, infrared, and
 * every refusal at opening. The last test covers the pairing of pictures. */
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

#include "drivers/sensor/picture/picture_pair.h"
#include "tests/drivers/sensor/v4l2_rig.h"
#include "tests/support/devices/manual_clock.h"
#include "tests/support/scratch.h"

/* ---- depth ------------------------------------------------------------------ */

static void frames_are_what_the_camera_gave(void **state)
{
    (void)state;
    struct iso_sensor *sensor = v4l2_started(false);
    const struct iso_frame *frame = NULL;
    assert_int_equal(v4l2_look(sensor, &frame, NULL), -ETIMEDOUT);
    for (int i = 0; i < 12; i++) { /* more pictures than buffers */
        v4l2_at(33 * i + 10);
        v4l2_shoot_depth(i, 33 * i, FAKE_GOOD);
        assert_int_equal(v4l2_look(sensor, &frame, NULL), 0);
        v4l2_assert_frame(frame, i, 33 * i);
        assert_int_equal(frame->sequence, i);
        assert_null(frame->intensity);
    }
    assert_int_equal(v4l2_look(sensor, &frame, NULL), -ETIMEDOUT);
    assert_int_equal(iso_sensor_health(sensor).lost, 0);
    struct iso_sensor_description description;
    assert_int_equal(iso_sensor_describe(sensor, &description), 0);
    assert_string_equal(description.model, "d435");
    assert_string_equal(description.serial, "fake:/dev/depth");
    assert_false(description.intensity);
    assert_true(description.unit_mm == 0.5);
    assert_true(iso_sensor_poll_fd(sensor) >= 0);
    iso_sensor_close(sensor);
}

/* The description says whether the intrinsics are nominal. */
static void tells_whether_its_intrinsics_are_nominal(void **state)
{
    static const struct {
        const char *line, *calibration;
    } cases[] = {{"", "camera.ini, 0.5 mm a count"},
                 {"nominal = no\n", "camera.ini, 0.5 mm a count"},
                 {"nominal = yes\n", "camera.ini), 0.5 mm a count"}};
    struct iso_sensor_description description;
    char text[512];
    (void)state;
    for (size_t i = 0; i < 3; i++) {
        (void)snprintf(text, sizeof text, "%s%s", v4l2_camera_ini, cases[i].line);
        scratch_write_text(scratch_path(v4l2_scratch, "camera.ini"), text);
        struct iso_sensor *sensor = v4l2_started(false);
        assert_int_equal(iso_sensor_describe(sensor, &description), 0);
        assert_non_null(strstr(description.calibration, cases[i].calibration));
        assert_int_equal(strncmp(description.calibration, "nominal (", 9) == 0, i == 2);
        iso_sensor_close(sensor);
    }
}

static void lost_and_damaged_pictures_are_gaps(void **state)
{
    (void)state;
    struct iso_sensor *sensor = v4l2_started(false);
    const struct iso_frame *frame = NULL;
    struct iso_fault fault = {.text = ""};
    static const enum fake_fate fates[] = {FAKE_GOOD, FAKE_LOST, FAKE_DAMAGED, FAKE_SHORT,
                                           FAKE_GOOD};
    static const int expected[] = {0, -ETIMEDOUT, -EBADMSG, -EBADMSG, 0};
    for (int i = 0; i < 5; i++) {
        v4l2_at(33 * i + 5);
        v4l2_shoot_depth(i, 33 * i, fates[i]);
        assert_int_equal(v4l2_look(sensor, &frame, &fault), expected[i]);
    }
    assert_int_equal(frame->sequence, 4);
    assert_int_equal(iso_sensor_health(sensor).lost, 3);
    assert_int_equal(iso_sensor_health(sensor).faults, 2);
    assert_non_null(strstr(fault.text, "picture 43 came damaged"));
    iso_sensor_close(sensor);
}

/* A driver returns a picture late, or twice. The back end drops it, the last frame stays the newest
 * one, and the pictures that came too late are counted as lost. */
static void late_pictures_are_dropped(void **state)
{
    (void)state;
    struct iso_sensor *sensor = v4l2_started(false);
    const struct iso_frame *frame = NULL;
    struct iso_fault fault = {.text = ""};
    static const uint32_t numbers[] = {0, 4, 1, 2, 2, 4, 5};
    static const int expected[] = {0, 0, -EBADMSG, -EBADMSG, -EBADMSG, -EBADMSG, 0};
    static const int sequences[] = {0, 4, 4, 4, 4, 4, 5}; /* of the last good frame */
    for (int i = 0; i < 7; i++) {
        v4l2_at(33 * i + 5);
        v4l2_fake.cameras[0].sequence = 40 + numbers[i];
        v4l2_shoot_depth(i, 33 * i, FAKE_GOOD);
        assert_int_equal(v4l2_look(sensor, &frame, &fault), expected[i]);
        assert_int_equal(frame->sequence, sequences[i]);
    }
    assert_string_equal(fault.text, "sensor v4l2: picture 44 comes after picture 44");
    const struct iso_sensor_health health = iso_sensor_health(sensor);
    assert_int_equal(health.frames, 3);
    assert_int_equal(health.lost, 3);
    assert_int_equal(health.refused, 0); /* no frame was left for the class to refuse */
    assert_int_equal(health.device.dropped, 4);
    iso_sensor_close(sensor);
}

static void numbers_may_begin_anew_after_32_bits(void **state)
{
    (void)state;
    const struct iso_frame *frame = NULL;
    v4l2_fake.cameras[0].sequence = UINT32_MAX - 1;
    struct iso_sensor *sensor = v4l2_started(false);
    for (int i = 0; i < 4; i++) {
        v4l2_at(33 * i + 5);
        v4l2_shoot_depth(i, 33 * i, i == 2 ? FAKE_LOST : FAKE_GOOD);
        assert_int_equal(v4l2_look(sensor, &frame, NULL), i == 2 ? -ETIMEDOUT : 0);
    }
    assert_int_equal(frame->sequence, 3);
    assert_int_equal(iso_sensor_health(sensor).lost, 1);
    iso_sensor_close(sensor);
}

static void sequence_and_time_go_on_over_a_stop(void **state)
{
    (void)state;
    struct iso_sensor *sensor = v4l2_started(false);
    const struct iso_frame *frame = NULL;
    v4l2_at(40);
    v4l2_shoot_depth(1, 33, FAKE_GOOD);
    assert_int_equal(v4l2_look(sensor, &frame, NULL), 0);
    int64_t before_ns = frame->t_ns;
    assert_int_equal(iso_sensor_stop(sensor, NULL), 0);
    v4l2_fake.cameras[0].sequence = 0; /* as drivers do */
    assert_int_equal(iso_sensor_start(sensor, NULL), 0);
    /* An earlier time stamp does not make the time go back. */
    v4l2_shoot_depth(2, 20, FAKE_GOOD);
    assert_int_equal(v4l2_look(sensor, &frame, NULL), 0);
    assert_int_equal(frame->sequence, 1);
    assert_true(frame->t_ns == before_ns + 1);
    iso_sensor_close(sensor);
}

static void a_driver_with_another_clock_gets_the_time_of_arrival(void **state)
{
    (void)state;
    v4l2_fake.cameras[0].realtime_stamps = true;
    struct iso_sensor *sensor = v4l2_started(false);
    const struct iso_frame *frame = NULL;
    v4l2_at(50);
    v4l2_shoot_depth(1, 999999, FAKE_GOOD);
    assert_int_equal(v4l2_look(sensor, &frame, NULL), 0);
    assert_int_equal(frame->t_ns, v4l2_now_ns);
    iso_sensor_close(sensor);
}

static void an_unplugged_camera_is_lost(void **state)
{
    (void)state;
    struct iso_sensor *sensor = v4l2_started(true);
    const struct iso_frame *frame = NULL;
    struct iso_fault fault = {.text = ""};
    fake_unplug(&v4l2_fake.cameras[1]);
    assert_int_equal(v4l2_look(sensor, &frame, &fault), -ENODEV);
    assert_non_null(strstr(fault.text, "/dev/ir: the device is gone"));
    assert_int_equal(fault.code, ISO_FAULT_SENSOR_GONE);
    assert_int_equal(iso_sensor_health(sensor).state, ISO_SENSOR_LOST);
    assert_int_equal(v4l2_look(sensor, &frame, &fault), -ENODEV);
    v4l2_fake.cameras[1].streaming = false; /* unplugging has ended the stream */
    iso_sensor_close(sensor);
}

static void a_broken_stream_may_be_started_again(void **state)
{
    (void)state;
    struct iso_sensor *sensor = v4l2_started(false);
    const struct iso_frame *frame = NULL;
    struct iso_fault fault = {.text = ""};
    fake_break(&v4l2_fake.cameras[0]);
    assert_int_equal(v4l2_look(sensor, &frame, &fault), -EIO);
    assert_non_null(strstr(fault.text, "/dev/depth: the stream broke"));
    assert_int_equal(fault.code, ISO_FAULT_SENSOR_FAILED);
    v4l2_fake.cameras[0].broken = false;
    assert_int_equal(iso_sensor_stop(sensor, NULL), 0);
    assert_int_equal(iso_sensor_start(sensor, NULL), 0);
    v4l2_at(10);
    v4l2_shoot_depth(3, 5, FAKE_GOOD);
    assert_int_equal(v4l2_look(sensor, &frame, NULL), 0);
    v4l2_assert_frame(frame, 3, 5);
    iso_sensor_close(sensor);
}

/* ---- depth and infrared ----------------------------------------------------- */

static void infrared_finds_its_depth(void **state)
{
    (void)state;
    struct iso_sensor *sensor = v4l2_started(true);
    const struct iso_frame *frame = NULL;
    v4l2_at(40);
    v4l2_shoot_ir(1, 34, FAKE_GOOD);
    assert_int_equal(v4l2_look(sensor, &frame, NULL), -ETIMEDOUT);
    v4l2_shoot_depth(1, 33, FAKE_GOOD);
    assert_int_equal(v4l2_look(sensor, &frame, NULL), 0);
    v4l2_assert_frame(frame, 1, 33);
    /* Depth 2 has no partner, depth 3 has one. */
    v4l2_at(110);
    v4l2_shoot_depth(2, 66, FAKE_GOOD);
    v4l2_shoot_ir(2, 67, FAKE_LOST);
    assert_int_equal(v4l2_look(sensor, &frame, NULL), -ETIMEDOUT);
    v4l2_shoot_depth(3, 99, FAKE_GOOD);
    v4l2_shoot_ir(3, 100, FAKE_GOOD);
    assert_int_equal(v4l2_look(sensor, &frame, NULL), 0);
    v4l2_assert_frame(frame, 3, 99);
    assert_int_equal(frame->sequence, 2);
    assert_int_equal(iso_sensor_health(sensor).lost, 1);
    assert_int_equal(iso_sensor_health(sensor).device.dropped, 1);
    iso_sensor_close(sensor);
}

/* ---- opening ---------------------------------------------------------------- */

static void refuses_cameras(int error, enum iso_fault_code code, const char *words)
{
    struct iso_sensor *sensor = NULL;
    struct iso_fault fault = {.text = ""};
    int got = v4l2_open_sensor(true, &sensor, &fault);
    if (got != error || fault.code != code || !strstr(fault.text, words)) {
        fail_msg("%d, %s, '%s' is not %d, %s, '%s'", got, iso_fault_code_name(fault.code),
                 fault.text, error, iso_fault_code_name(code), words);
    }
    assert_null(sensor);
    fake_v4l2_assert_released(&v4l2_fake);
}

static void refuses_cameras_that_will_not_do(void **state)
{
    (void)state;
    const struct fake_camera good = v4l2_fake.cameras[1];
    struct fake_camera *ir = &v4l2_fake.cameras[1];
    ir->path = "/dev/elsewhere";
    refuses_cameras(-ENODEV, ISO_FAULT_SENSOR_MISSING,
                    "sensor v4l2: /dev/ir: cannot be opened: No such file");
    *ir = good;
    ir->open_error = -EACCES;
    refuses_cameras(-EACCES, ISO_FAULT_SENSOR_DENIED, "Permission denied");
    *ir = good;
    ir->open_error = -EBUSY;
    refuses_cameras(-EBUSY, ISO_FAULT_SENSOR_BUSY, "busy");
    *ir = good;
    ir->capabilities = V4L2_CAP_VIDEO_OUTPUT | V4L2_CAP_STREAMING;
    refuses_cameras(-ENODEV, ISO_FAULT_SENSOR_UNFIT, "/dev/ir: is not a camera that streams");
    *ir = good;
    ir->format = V4L2_PIX_FMT_MJPEG;
    refuses_cameras(-EINVAL, ISO_FAULT_SENSOR_FORMAT,
                    "/dev/ir (Fake camera): has none of the required pixel formats");
    *ir = good;
    ir->height_px = 50;
    refuses_cameras(-EINVAL, ISO_FAULT_SENSOR_FORMAT, "delivers 70 x 50, not 70 x 48");
    *ir = good;
    scratch_write_text(scratch_path(v4l2_scratch, "camera.ini"), "[recording]\n");
    refuses_cameras(-EINVAL, ISO_FAULT_CALIBRATION_WRONG, "camera.ini: format is missing");
}

static void a_camera_that_does_not_start_holds_nothing(void **state)
{
    (void)state;
    struct iso_sensor *sensor = NULL;
    struct iso_fault fault = {.text = ""};
    v4l2_fake.cameras[1].start_error = -ENOSPC; /* the kernel's error for a full USB bus */
    assert_int_equal(v4l2_open_sensor(true, &sensor, NULL), 0);
    assert_int_equal(iso_sensor_start(sensor, &fault), -EIO);
    assert_non_null(strstr(fault.text, "/dev/ir: does not stream: No space left"));
    assert_int_equal(fault.code, ISO_FAULT_USB_FULL);
    assert_int_equal(v4l2_fake.cameras[0].n_mapped + v4l2_fake.cameras[1].n_mapped, 0);
    assert_false(v4l2_fake.cameras[0].streaming);
    v4l2_fake.cameras[1].start_error = 0;
    assert_int_equal(iso_sensor_start(sensor, NULL), 0);
    iso_sensor_close(sensor);
}

static void there_is_no_such_device_on_the_machine(void **state)
{
    (void)state;
    struct iso_clock clock = manual_clock(&v4l2_now_ns);
    struct iso_option options[] = {{"device", "/dev/no-such-camera"},
                                   {"camera", scratch_path(v4l2_scratch, "camera.ini")}};
    struct iso_sensor *sensor = NULL;
    struct iso_fault fault = {.text = ""};
    assert_int_equal(iso_sensor_open("v4l2", options, 2, &clock, &sensor, &fault), -ENODEV);
    options[0].value = "/dev/null";
    assert_int_equal(iso_sensor_open("v4l2", options, 2, &clock, &sensor, &fault), -ENODEV);
    assert_string_equal(fault.text, "sensor v4l2: /dev/null: is not a video device");
    assert_int_equal(iso_sensor_open("v4l2", options, 1, &clock, &sensor, &fault), -EINVAL);
    assert_string_equal(fault.text, "sensor v4l2: option 'camera' is missing");
}

/* ---- pairs ------------------------------------------------------------------ */

static void pairs_are_those_nearest_in_time(void **state)
{
    (void)state;
    static const struct {
        int64_t first[3], second[3];
        size_t n_first, n_second;
        enum iso_pair_verdict verdict;
    } cases[] = {
        {{0}, {0}, 0, 0, ISO_PAIR_WAIT},
        {{100}, {0}, 1, 0, ISO_PAIR_WAIT},
        {{100}, {103}, 1, 1, ISO_PAIR_TAKE},
        {{103}, {100}, 1, 1, ISO_PAIR_TAKE},
        {{100}, {110}, 1, 1, ISO_PAIR_TAKE},       /* just within the limit */
        {{100}, {111}, 1, 1, ISO_PAIR_DROP_FIRST}, /* just beyond the limit */
        {{111}, {100}, 1, 1, ISO_PAIR_DROP_SECOND},
        {{100, 107}, {108}, 2, 1, ISO_PAIR_DROP_FIRST}, /* a nearer one follows */
        {{100, 120}, {108}, 2, 1, ISO_PAIR_TAKE},
        {{108}, {100, 107}, 1, 2, ISO_PAIR_DROP_SECOND},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        assert_int_equal(iso_pair_judge(cases[i].first, cases[i].n_first, cases[i].second,
                                        cases[i].n_second, 10),
                         cases[i].verdict);
    }
}

#define ON_FAKE(test) cmocka_unit_test_setup_teardown(test, v4l2_set_up, v4l2_tear_down)

int main(void)
{
    const struct CMUnitTest tests[] = {
        ON_FAKE(frames_are_what_the_camera_gave),
        ON_FAKE(tells_whether_its_intrinsics_are_nominal),
        ON_FAKE(lost_and_damaged_pictures_are_gaps),
        ON_FAKE(late_pictures_are_dropped),
        ON_FAKE(numbers_may_begin_anew_after_32_bits),
        ON_FAKE(sequence_and_time_go_on_over_a_stop),
        ON_FAKE(a_driver_with_another_clock_gets_the_time_of_arrival),
        ON_FAKE(an_unplugged_camera_is_lost),
        ON_FAKE(a_broken_stream_may_be_started_again),
        ON_FAKE(infrared_finds_its_depth),
        ON_FAKE(refuses_cameras_that_will_not_do),
        ON_FAKE(a_camera_that_does_not_start_holds_nothing),
        ON_FAKE(there_is_no_such_device_on_the_machine),
        cmocka_unit_test(pairs_are_those_nearest_in_time),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
