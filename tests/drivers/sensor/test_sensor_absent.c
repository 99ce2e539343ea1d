/* The contract of the sensor class for a machine without a device. The tests use the real library
 * or the kernel itself, and no stand-in. */
#include <errno.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "drivers/sensor/contract/sensor.h"
#include "tests/support/devices/manual_clock.h"
#include "tests/support/devices/stereo_wall.h"
#include "tests/support/scratch.h"
#include "tests/support/stored_frames.h"

static void count_device(const struct iso_sensor_device *device, void *context)
{
    int *n = context;
    assert_true(strlen(device->id) > 0);
    ++*n;
}

static bool is_registered(const char *back_end)
{
    for (size_t r = 0; iso_sensor_registered(r); r++) {
        if (strcmp(iso_sensor_registered(r), back_end) == 0) {
            return true;
        }
    }
    return false;
}

/* The tests call the real library or the kernel again and again. The back end must not hold a
 * resource that would prevent the next call. */
static void ask_in_vain(const char *back_end, const struct iso_option *options, size_t n_options)
{
    int64_t now_ns = 0;
    const struct iso_clock clock = manual_clock(&now_ns);
    for (int i = 0; i < 3; i++) {
        struct iso_sensor *sensor = NULL;
        struct iso_fault fault = {.text = ""};
        int n = 0;
        const int error = iso_sensor_open(back_end, options, n_options, &clock, &sensor, &fault);
        if (error != -ENODEV) {
            fail_msg("%s: %d: %s", back_end, error, fault.text);
        }
        assert_non_null(strstr(fault.text, back_end));
        assert_null(sensor);
        assert_int_equal(iso_sensor_probe(back_end, count_device, &n, &fault), 0);
        if (i == 0) {
            print_message("  %s: %d devices, but not the requested one\n", back_end, n);
        }
    }
}

static void a_missing_device_is_reported(void **state)
{
    const char *rig = scratch_path(*state, "rig.ini"), *camera = scratch_path(*state, "camera.ini");
    const struct {
        const char *back_end;
        struct iso_option options[3];
        size_t n_options;
    } cases[] = {
        {"v4l2", {{"device", "/dev/no-such-camera"}, {"camera", camera}}, 2},
        {"v4l2-stereo",
         {{"left", "/dev/no-such-left"}, {"right", "/dev/no-such-right"}, {"calibration", rig}},
         3},
        {"libcamera-stereo",
         {{"left", "no-such-left"}, {"right", "no-such-right"}, {"calibration", rig}},
         3},
        {"openni2", {{"device", "no-such-serial"}}, 1},
    };
    stereo_wall_write_rig(rig);
    scratch_write_text(camera, stored_ini);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        if (is_registered(cases[i].back_end)) {
            ask_in_vain(cases[i].back_end, cases[i].options, cases[i].n_options);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(a_missing_device_is_reported, scratch_setup,
                                        scratch_teardown),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
