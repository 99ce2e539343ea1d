/* Reads real recordings, if they are present: ISOTHERM_SHARED/data/kinect2-faces. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "drivers/recording/recording.h"
#include "tests/support/scratch.h"
#include "tests/support/shared_data.h"

enum { PEOPLE = 7, FRAMES = 54, MARKS = 15 };

static struct iso_recording *open_person(int person)
{
    struct iso_recording *recording = NULL;
    struct iso_fault fault = {.text = ""};
    char name[8];
    if (!scratch_exists(shared_data("data/kinect2-faces"))) {
        skip();
    }
    (void)snprintf(name, sizeof name, "k%02d", person);
    int error = iso_recording_open(scratch_path(shared_data("data/kinect2-faces"), name),
                                   &recording, &fault);
    assert_string_equal(fault.text, "");
    assert_int_equal(error, 0);
    return recording;
}

static void every_frame_is_read(void **state)
{
    size_t read = 0;
    (void)state;
    for (int person = 0; person < PEOPLE; person++) {
        struct iso_recording *recording = open_person(person);
        struct iso_frame *frame;
        assert_true(iso_recording_has_intensity(recording));
        assert_int_equal(iso_recording_frame_new(recording, &frame), 0);
        for (size_t i = 0; i < iso_recording_frames(recording); i++, read++) {
            assert_int_equal(iso_recording_read(recording, i, frame, NULL), 0);
            assert_int_equal(iso_frame_check(frame, NULL), 0);
        }
        iso_frame_free(frame);
        iso_recording_close(recording);
    }
    assert_int_equal(read, PEOPLE * FRAMES);
}

/* The marked nose tip has the depth that was measured there. So the reader, the units and the
 * directions of the axes agree with the authors of the corpus. */
static void marks_lie_on_the_surface(void **state)
{
    (void)state;
    for (int person = 0; person < PEOPLE; person++) {
        struct iso_recording *recording = open_person(person);
        struct iso_recording_landmark *rows = NULL;
        struct iso_frame *frame;
        size_t n = 0;
        assert_int_equal(iso_recording_landmarks(recording, &rows, &n, NULL), 0);
        assert_int_equal(n, FRAMES * MARKS);
        assert_int_equal(iso_recording_frame_new(recording, &frame), 0);
        for (size_t i = 0; i < n; i++) {
            double u = 0.0, v = 0.0;
            if (strcmp(rows[i].name, "nose_tip") != 0) {
                continue;
            }
            assert_int_equal(iso_recording_read(recording, rows[i].frame, frame, NULL), 0);
            assert_true(iso_camera_project(&frame->camera, rows[i].point_mm, &u, &v));
            float depth = iso_frame_depth_at(frame, (int)(u + 0.5), (int)(v + 0.5));
            assert_true(depth > rows[i].point_mm.z - 15.0 && depth < rows[i].point_mm.z + 15.0);
        }
        free(rows);
        iso_frame_free(frame);
        iso_recording_close(recording);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_frame_is_read),
        cmocka_unit_test(marks_lie_on_the_surface),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
