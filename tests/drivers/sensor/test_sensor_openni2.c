/* Tests of the back end openni2 beyond the contract: its options, its frames, looped files, and a
 * camera that fails. */
#include <errno.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "drivers/sensor/contract/sensor.h"
#include "drivers/sensor/openni2/sensor_openni2.h"
#include "tests/support/devices/camera_bench.h"
#include "tests/support/devices/manual_clock.h"
#include "tests/support/scratch.h"
#include "tests/support/stored_frames.h"

#define MS INT64_C(1000000)

static int64_t now_ns;
static int shutter_fd = -1;

/* A camera with units of 0.1 mm on a bench, and three frames for it. */
static int setup(void **state)
{
    void *scratch = NULL;
    int error = scratch_setup(&scratch);
    *state = scratch;
    if (!error) {
        stored_frames_write_plain(scratch_path(scratch, "r"), 3, 0.1, true);
        shutter_fd = camera_bench_make(scratch_path(scratch, "bench"), scratch_path(scratch, "r"),
                                       true);
    }
    now_ns = 9000 * MS;
    return error;
}

static int teardown(void **state)
{
    iso_sensor_openni2_forget(); /* the runtime reads the name of the bench only when it starts */
    camera_bench_leave(shutter_fd);
    return scratch_teardown(state);
}

static int open_with(const char *key, const char *value, struct iso_sensor **sensor,
                     struct iso_fault *fault)
{
    const struct iso_option options[] = {{key, value}};
    struct iso_clock clock = manual_clock(&now_ns);
    return iso_sensor_open("openni2", options, key ? 1 : 0, &clock, sensor, fault);
}

static void assert_refused(const char *key, const char *value, int error, const char *text)
{
    struct iso_sensor *sensor = NULL;
    struct iso_fault fault = {.text = ""};
    assert_int_equal(open_with(key, value, &sensor, &fault), error);
    if (!strstr(fault.text, text)) {
        fail_msg("'%s' is not in '%s'", text, fault.text);
    }
    assert_null(sensor);
}

static void refuses_bad_options(void **state)
{
    (void)state;
    assert_refused("unit", "1cm", -EINVAL, "bad value '1cm' for 'unit' (finest|100um|1mm)");
    assert_refused("intensity", "yes", -EINVAL, "bad value 'yes' for 'intensity' (no|ir|color)");
    assert_refused("mode", "640x480", -EINVAL, "mode: '640x480' is not WIDTHxHEIGHT@HZ");
    assert_refused("mode", "640x480@30fps", -EINVAL,
                   "mode: '640x480@30fps' is not WIDTHxHEIGHT@HZ");
    assert_refused("intrinsics", "570 571 3", -EINVAL,
                   "intrinsics: '570 571 3' is not FX FY CX CY");
    assert_refused("intrinsics", "570 571 3 -900", -EINVAL, "option 'intrinsics': ");
    assert_refused("pace", "asap", -EINVAL, "need a file");
}

static void refuses_what_the_camera_cannot(void **state)
{
    (void)state;
    assert_refused("mode", "640x480@30", -EINVAL, "no depth mode of 2 fits; now it is 7x5@30");
    assert_refused("intensity", "color", -EINVAL, "cannot register depths to colours");
    assert_refused("path", "/nowhere/x.oni", -ENODEV, "/nowhere/x.oni: No such file or directory");
    assert_refused("path", "/etc/passwd", -ENODEV, "/etc/passwd");
}

static void finds_a_camera_by_uri_and_by_serial_number(void **state)
{
    struct iso_sensor *sensor = NULL;
    struct iso_sensor_description description;
    char uri[256];
    (void)snprintf(uri, sizeof uri, "bench:%s", scratch_path(*state, "bench"));
    assert_int_equal(open_with("device", uri, &sensor, NULL), 0);
    assert_int_equal(iso_sensor_describe(sensor, &description), 0);
    assert_string_equal(description.serial, "BENCH-1");
    assert_string_equal(description.model, "astra");
    assert_true(description.rate_hz == 30.0);
    iso_sensor_close(sensor);
    sensor = NULL;
    assert_int_equal(open_with("device", "BENCH-1", &sensor, NULL), 0);
    iso_sensor_close(sensor);
    assert_refused("device", "BENCH-2", -ENODEV, uri); /* the fault lists the present devices */
}

static void note_device(const struct iso_sensor_device *device, void *context)
{
    struct iso_sensor_device *seen = context;
    *seen = *device;
}

static void sees_what_is_plugged_in(void **state)
{
    struct iso_sensor_device seen = {.id = ""};
    struct iso_fault fault = {.text = ""};
    assert_int_equal(iso_sensor_probe("openni2", note_device, &seen, &fault), 0);
    assert_non_null(strstr(seen.id, "bench:/"));
    assert_string_equal(seen.label, "Isotherm astra");
    camera_bench_plug(scratch_path(*state, "bench"), false);
    seen.id[0] = '\0';
    assert_int_equal(iso_sensor_probe("openni2", note_device, &seen, &fault), 0);
    assert_string_equal(seen.id, "");
    assert_refused(NULL, NULL, -ENODEV, "no device; OpenNI2 sees: none");
    assert_int_equal(iso_sensor_probe("replay", note_device, &seen, &fault), -ENOSYS);
    assert_int_equal(iso_sensor_probe("kinect9", note_device, &seen, &fault), -ENOENT);
}

static const struct iso_frame *next(struct iso_sensor *sensor)
{
    const struct iso_frame *frame = NULL;
    struct iso_fault fault = {.text = ""};
    now_ns += 33 * MS;
    camera_bench_press(shutter_fd);
    if (iso_sensor_wait(sensor, now_ns + 10000 * MS, &frame, &fault)) {
        fail_msg("%s", fault.text);
    }
    return frame;
}

static void takes_the_unit_it_is_told(void **state)
{
    static const struct {
        const char *unit;
        double unit_mm;
        float depth_mm; /* depth of count 1001 in units of 0.1 mm */
    } cases[] = {{"finest", 0.1, 100.1F}, {"100um", 0.1, 100.1F}, {"1mm", 1.0, 100.0F}};
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct iso_sensor *sensor = NULL;
        struct iso_sensor_description description;
        assert_int_equal(open_with("unit", cases[i].unit, &sensor, NULL), 0);
        assert_int_equal(iso_sensor_describe(sensor, &description), 0);
        assert_true(description.unit_mm == cases[i].unit_mm);
        assert_int_equal(iso_sensor_start(sensor, NULL), 0);
        assert_true(iso_frame_depth_at(next(sensor), 1, 0) == cases[i].depth_mm);
        iso_sensor_close(sensor);
    }
}

static void takes_the_camera_it_is_told(void **state)
{
    struct iso_sensor *sensor = NULL;
    (void)state;
    assert_int_equal(open_with("intrinsics", "570.25 571.5 3.25 1.75", &sensor, NULL), 0);
    assert_int_equal(iso_sensor_start(sensor, NULL), 0);
    const struct iso_camera *camera = &next(sensor)->camera;
    assert_true(camera->fx_px == 570.25 && camera->fy_px == 571.5);
    assert_true(camera->cx_px == 3.25 && camera->cy_px == 1.75);
    iso_sensor_close(sensor);
}

#define CAMERA_INI(size, nominal)                                                          \
    "[recording]\nformat = 1\nsensor = xtion\n[depth]\nprojection = pinhole\n" size        \
    "fx_px = 570.25\nfy_px = 571.5\ncx_px = 3.25\ncy_px = 1.75\nk1 = 0.125\nunit_mm = 1\n" \
    "nominal = " nominal "\n"

static void takes_a_camera_file(void **state)
{
    struct iso_sensor *sensor = NULL;
    struct iso_sensor_description description;
    const char *path = scratch_path(*state, "camera.ini");
    scratch_write_text(path, CAMERA_INI("width_px = 7\nheight_px = 5\n", "yes"));
    assert_int_equal(open_with("camera", path, &sensor, NULL), 0);
    assert_int_equal(iso_sensor_start(sensor, NULL), 0);
    const struct iso_camera *camera = &next(sensor)->camera;
    assert_true(camera->fx_px == 570.25 && camera->cy_px == 1.75 && camera->k1 == 0.125);
    assert_int_equal(iso_sensor_describe(sensor, &description), 0);
    assert_memory_equal(description.calibration, "nominal (", 9);
    iso_sensor_close(sensor);
    scratch_write_text(path, CAMERA_INI("width_px = 70\nheight_px = 5\n", "no"));
    assert_refused("camera", path, -EINVAL, "the camera gives 7 x 5, ");
    scratch_write_text(path, CAMERA_INI("width_px = 7\nheight_px = 5\n", "perhaps"));
    assert_refused("camera", path, -EINVAL, "bad value 'perhaps' for nominal");
    assert_refused("camera", scratch_path(*state, "none.ini"), -ENOENT, "none.ini: No such file");
}

/* A camera that reports an error has ended its stream. */
static void reports_a_camera_that_fails(void **state)
{
    struct iso_sensor *sensor = NULL;
    const struct iso_frame *frame = NULL;
    struct iso_fault fault = {.text = ""};
    assert_int_equal(open_with(NULL, NULL, &sensor, NULL), 0);
    assert_int_equal(iso_sensor_start(sensor, NULL), 0);
    (void)next(sensor);
    scratch_write(scratch_path(*state, "r/depth/000001.png"), "PNG", 3);
    camera_bench_press(shutter_fd);
    assert_int_equal(iso_sensor_wait(sensor, now_ns + 10000 * MS, &frame, &fault), -EIO);
    assert_non_null(strstr(fault.text, "the device reports an error"));
    assert_string_equal(iso_sensor_health(sensor).device.state, "error");
    assert_int_equal(iso_sensor_stop(sensor, NULL), 0);
    assert_int_equal(iso_sensor_start(sensor, NULL), 0); /* stop and start repair it */
    assert_true(iso_frame_depth_at(next(sensor), 1, 0) == 100.1F);
    assert_string_equal(iso_sensor_health(sensor).device.state, "");
    iso_sensor_close(sensor);
}

static void record(const char *path)
{
    struct iso_sensor *sensor = NULL;
    assert_int_equal(open_with("record", path, &sensor, NULL), 0);
    assert_int_equal(iso_sensor_start(sensor, NULL), 0);
    for (int i = 0; i < 3; i++) {
        (void)next(sensor);
    }
    iso_sensor_close(sensor);
}

static void plays_a_file_over_and_over_in_time(void **state)
{
    const char *path = scratch_path(*state, "x.oni");
    const struct iso_option options[] = {{"path", path}, {"loop", "yes"}, {"pace", "realtime"}};
    struct iso_clock clock = manual_clock(&now_ns);
    struct iso_sensor *sensor = NULL;
    record(path);
    assert_int_equal(iso_sensor_open("openni2", options, 3, &clock, &sensor, NULL), 0);
    assert_int_equal(iso_sensor_start(sensor, NULL), 0);
    const int64_t began_ns = now_ns;
    for (int i = 0; i < 8; i++) {
        const struct iso_frame *frame = NULL;
        int64_t due_ns = 0;
        if (i > 0) { /* not too early */
            assert_int_equal(iso_sensor_wait(sensor, now_ns, &frame, NULL), -ETIMEDOUT);
            assert_int_equal(iso_sensor_next_due_ns(sensor, &due_ns), 0);
            now_ns = due_ns;
        }
        assert_int_equal(iso_sensor_wait(sensor, now_ns, &frame, NULL), 0);
        assert_true(iso_frame_depth_at(frame, 1, 0) == (float)((1001 + 100 * (i % 3)) * 0.1));
        assert_int_equal(frame->sequence, i);
        assert_int_equal(frame->t_ns, now_ns);
        /* the camera's own clock advances by 33.333 ms each frame */
        assert_in_range(frame->t_ns - began_ns, i * 33 * MS, i * 34 * MS);
    }
    iso_sensor_close(sensor);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(refuses_bad_options, setup, teardown),
        cmocka_unit_test_setup_teardown(refuses_what_the_camera_cannot, setup, teardown),
        cmocka_unit_test_setup_teardown(finds_a_camera_by_uri_and_by_serial_number, setup,
                                        teardown),
        cmocka_unit_test_setup_teardown(sees_what_is_plugged_in, setup, teardown),
        cmocka_unit_test_setup_teardown(takes_the_unit_it_is_told, setup, teardown),
        cmocka_unit_test_setup_teardown(takes_the_camera_it_is_told, setup, teardown),
        cmocka_unit_test_setup_teardown(takes_a_camera_file, setup, teardown),
        cmocka_unit_test_setup_teardown(reports_a_camera_that_fails, setup, teardown),
        cmocka_unit_test_setup_teardown(plays_a_file_over_and_over_in_time, setup, teardown),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
