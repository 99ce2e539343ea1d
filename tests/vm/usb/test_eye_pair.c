/* The product's stereo matcher finds the depths of a frame again in the pictures that the stereo
 * cameras of the virtual machine show of it (eye_pair.h). */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "drivers/recording/recording.h"
#include "drivers/stereo/stereo.h"
#include "tests/vm/usb/eye_pair.h"

enum { ROOM_MM = 1000 }; /* nearer pixels belong to the person */

struct seen {
    int measured, missing, off; /* pixels of the person in the frame; those without a depth from the
                                   matcher; those off by more than 5 mm */
    double sum_mm2;             /* sum of the squared errors of all others */
};

static struct seen compare(const struct iso_frame *there, const struct iso_frame *seen)
{
    struct seen s = {0};
    for (int i = 0; i < there->width_px * there->height_px; i++) {
        const double z_mm = (double)there->depth_mm[i];
        const double error_mm = (double)seen->depth_mm[i] - z_mm;
        if (i % there->width_px < 100 || !(z_mm > 0.0 && z_mm < ROOM_MM)) {
            continue; /* the right camera does not see the left edge */
        }
        s.measured++;
        if (!(seen->depth_mm[i] > 0.0f)) {
            s.missing++;
        } else if (fabs(error_mm) > 5.0) {
            s.off++;
        } else {
            s.sum_mm2 += error_mm * error_mm;
        }
    }
    return s;
}

static void depths_come_back(void **state)
{
    (void)state;
    const struct iso_stereo_options options = iso_stereo_options_default();
    struct iso_recording *recording = NULL;
    struct iso_frame *there = NULL, *seen = NULL;
    struct eye_pair *pair = NULL;
    struct iso_stereo *stereo = NULL;
    assert_int_equal(
        iso_recording_open(ISOTHERM_SOURCE_DIR "/sim/stored/p01-enrol", &recording, NULL), 0);
    assert_int_equal(iso_recording_frame_new(recording, &there), 0);
    assert_int_equal(iso_recording_frame_new(recording, &seen), 0);
    assert_int_equal(iso_recording_read(recording, 0, there, NULL), 0);
    assert_int_equal(eye_pair_new(&there->camera, &pair), 0);
    const struct iso_stereo_calibration calibration = eye_pair_calibration(pair);
    assert_int_equal(iso_stereo_new(&calibration, &options, &stereo, NULL), 0);
    const size_t n = (size_t)there->width_px * (size_t)there->height_px;
    uint8_t *left = calloc(n, 1), *right = calloc(n, 1);
    assert_true(left && right);
    eye_pair_look(pair, there, 1, left, right);
    assert_int_equal(iso_stereo_compute(stereo, left, right, NULL, seen), 0);
    const struct seen s = compare(there, seen);
    const double rms_mm = sqrt(s.sum_mm2 / (s.measured - s.missing - s.off));
    print_message("%d depths: %.1f %% missing, %.1f %% off by more than 5 mm, else %.2f mm rms\n",
                  s.measured, 100.0 * s.missing / s.measured, 100.0 * s.off / s.measured, rms_mm);
    assert_true(s.measured > 20000);
    assert_true(s.missing < s.measured / 10);
    assert_true(s.off < s.measured / 20);
    assert_true(rms_mm < 1.5);
    free(left);
    free(right);
    iso_stereo_free(stereo);
    eye_pair_free(pair);
    iso_frame_free(there);
    iso_frame_free(seen);
    iso_recording_close(recording);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(depths_come_back),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
