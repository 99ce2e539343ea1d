#include "tests/support/devices/stereo_wall.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>

#include "drivers/stereo/calibration.h"

void stereo_wall_write_rig(const char *path)
{
    struct iso_camera camera = {.projection = ISO_PINHOLE,
                                .width_px = WALL_WIDTH,
                                .height_px = WALL_HEIGHT,
                                .fx_px = WALL_FOCAL_PX,
                                .fy_px = WALL_FOCAL_PX,
                                .cx_px = 0.5 * (WALL_WIDTH - 1),
                                .cy_px = 0.5 * (WALL_HEIGHT - 1)};
    struct iso_stereo_calibration calibration = {
        .camera = {camera, camera},
        .right_from_left = {iso_mat3_identity(), {-WALL_BASELINE_MM, 0.0, 0.0}}};
    assert_int_equal(iso_stereo_calibration_write(path, &calibration, NULL), 0);
}

double stereo_wall_level(int x, int y)
{
    double sum = 0.0;
    for (int i = 1; i <= 30; i++) {
        double rate = 0.2 + 0.02 * i;
        sum += sin(rate * (x * cos(2.4 * i) + y * sin(2.4 * i)) + 1.7 * i * i);
    }
    return fmin(fmax(128.0 + 15.0 * sum, 0.0), 255.0);
}

void stereo_wall_picture(int shift_px, uint8_t *grey)
{
    enum { WIDE = WALL_WIDTH + 2 * WALL_SHIFT_MAX };
    static uint8_t wall[WALL_HEIGHT][WIDE]; /* made once: it takes a million sines */
    static bool made;
    assert_true(shift_px >= -WALL_SHIFT_MAX && shift_px <= WALL_SHIFT_MAX);
    for (int i = 0; !made && i < WALL_HEIGHT * WIDE; i++) {
        wall[i / WIDE][i % WIDE] = (uint8_t)stereo_wall_level(i % WIDE - WALL_SHIFT_MAX, i / WIDE);
    }
    made = true;
    for (int y = 0; y < WALL_HEIGHT; y++) {
        memcpy(grey + y * WALL_WIDTH, &wall[y][WALL_SHIFT_MAX - shift_px], WALL_WIDTH);
    }
}
