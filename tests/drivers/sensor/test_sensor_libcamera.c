/* The back end libcamera-stereo on a machine without its cameras. The library is started, asked for
 * cameras, and released again. */
#include <errno.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "drivers/sensor/contract/sensor.h"
#include "drivers/sensor/libcamera/libcamera_pair.h"
#include "tests/support/devices/manual_clock.h"
#include "tests/support/devices/stereo_wall.h"
#include "tests/support/scratch.h"

static int64_t now_ns = 1000;

static int open_sensor(const char *calibration, struct iso_sensor **sensor, struct iso_fault *fault)
{
    struct iso_clock clock = manual_clock(&now_ns);
    struct iso_option options[] = {
        {"left", "no-such-left"}, {"right", "no-such-right"}, {"calibration", calibration}};
    return iso_sensor_open("libcamera-stereo", options, calibration ? 3 : 2, &clock, sensor, fault);
}

static void no_such_camera(void **state)
{
    const char *path = scratch_path(*state, "rig.ini");
    struct iso_sensor *sensor = NULL;
    struct iso_fault fault = {.text = ""};
    stereo_wall_write_rig(path);
    for (int i = 0; i < 3; i++) { /* nothing is held that would prevent the next start */
        assert_int_equal(open_sensor(path, &sensor, &fault), -ENODEV);
        assert_non_null(strstr(fault.text, "sensor libcamera-stereo: libcamera: no camera "
                                           "'no-such-left'; there are: "));
    }
    assert_null(sensor);
}

static void refuses_bad_options(void **state)
{
    (void)state;
    struct iso_sensor *sensor = NULL;
    struct iso_fault fault = {.text = ""};
    assert_int_equal(open_sensor(NULL, &sensor, &fault), -EINVAL);
    assert_string_equal(fault.text, "sensor libcamera-stereo: option 'calibration' is missing");
    assert_int_equal(open_sensor(scratch_path(*state, "none"), &sensor, &fault), -ENOENT);
    assert_non_null(strstr(fault.text, "none: No such file"));
    assert_null(sensor);
    iso_libcamera_pair_close(NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(no_such_camera, scratch_setup, scratch_teardown),
        cmocka_unit_test_setup_teardown(refuses_bad_options, scratch_setup, scratch_teardown),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
