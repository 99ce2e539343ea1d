/* The search on the frames of sim/stored: every face is found, and where nobody is, the costly
 * steps are not taken. The linker leads the calls of these steps here, where they are counted. */
#include <errno.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include <cmocka.h>

#include "drivers/recording/recording.h"
#include "tests/core/find/find_rig.h"
#include "tests/core/surfaces/rendered_head.h"

enum { SHRINK = 4, PEOPLE = 24, STRANGERS = 12 };

/* Calls since the beginning of a search. */
static int n_rigid_fits, n_head_fits;

int __real_iso_pose_fit(const struct iso_pose_vertices *vertices, const struct iso_frame *frame,
                        const struct iso_pose_options *options, const struct iso_rigid *start,
                        struct iso_pose_fit *out);
int __wrap_iso_pose_fit(const struct iso_pose_vertices *vertices, const struct iso_frame *frame,
                        const struct iso_pose_options *options, const struct iso_rigid *start,
                        struct iso_pose_fit *out);
int __real_iso_shape_fit_pose(struct iso_shape_fitter *fitter, const struct iso_frame *frame,
                              const struct iso_rigid *start, struct iso_pose_fit *out);
int __wrap_iso_shape_fit_pose(struct iso_shape_fitter *fitter, const struct iso_frame *frame,
                              const struct iso_rigid *start, struct iso_pose_fit *out);

int __wrap_iso_pose_fit(const struct iso_pose_vertices *vertices, const struct iso_frame *frame,
                        const struct iso_pose_options *options, const struct iso_rigid *start,
                        struct iso_pose_fit *out)
{
    n_rigid_fits++;
    return __real_iso_pose_fit(vertices, frame, options, start, out);
}

int __wrap_iso_shape_fit_pose(struct iso_shape_fitter *fitter, const struct iso_frame *frame,
                              const struct iso_rigid *start, struct iso_pose_fit *out)
{
    n_head_fits++;
    return __real_iso_shape_fit_pose(fitter, frame, start, out);
}

/* Searches, and counts the calls. */
static int find(struct find_rig *rig)
{
    struct iso_pose_fit fit;
    n_rigid_fits = n_head_fits = 0;
    return find_rig_find(rig, SHRINK, &fit);
}

/* Searches in every frame of a recording. Asserts that a face is found, if that is expected.
 * Returns the most fits that a frame took, rigid ones and those of the head. */
static int find_in_stored(struct find_rig *rig, const char *name, bool expected)
{
    char path[256];
    struct iso_recording *recording = NULL;
    int most = 0;
    (void)snprintf(path, sizeof path, "%s/sim/stored/%s", ISOTHERM_SOURCE_DIR, name);
    iso_frame_free(rig->frame);
    rig->frame = NULL;
    assert_int_equal(iso_recording_open(path, &recording, NULL), 0);
    assert_int_equal(iso_recording_frame_new(recording, &rig->frame), 0);
    for (size_t i = 0; i < iso_recording_frames(recording); i++) {
        assert_int_equal(iso_recording_read(recording, i, rig->frame, NULL), 0);
        const int error = find(rig);
        assert_true(!expected || error == 0);
        most = n_rigid_fits + n_head_fits > most ? n_rigid_fits + n_head_fits : most;
    }
    iso_recording_close(recording);
    print_message("%s: at most %d fits\n", name, most);
    return most;
}

static void every_stored_face_is_found(void **state)
{
    struct find_rig *rig = *state;
    char name[16];
    for (int i = 1; i <= PEOPLE; i++) {
        for (int visit = 0; visit < 3; visit++) {
            static const char *const visits[] = {"enrol", "v1", "v2"};
            (void)snprintf(name, sizeof name, "p%02d-%s", i, visits[visit]);
            assert_true(find_in_stored(rig, name, true) > 0);
        }
    }
    for (int i = 1; i <= STRANGERS; i++) {
        for (int visit = 1; visit <= 2; visit++) {
            (void)snprintf(name, sizeof name, "x%02d-v%d", i, visit);
            assert_true(find_in_stored(rig, name, true) > 0);
        }
    }
}

/* Nothing is measured, or there is a wall, near or far. */
static void a_scene_without_bumps_takes_no_fit(void **state)
{
    struct find_rig *rig = *state;
    const float walls_mm[] = {0.0f, 400.0f, 700.0f, 1500.0f, 3000.0f};
    for (size_t i = 0; i < sizeof walls_mm / sizeof *walls_mm; i++) {
        rendered_head_clear(rig->frame);
        if (walls_mm[i] > 0.0f) {
            rendered_head_wall(rig->frame, walls_mm[i]);
        }
        assert_int_equal(find(rig), -ENOENT);
        assert_int_equal(rig->n_candidates, 0);
        assert_int_equal(n_rigid_fits + n_head_fits, 0);
    }
}

/* The noise of a far wall is full of bumps, which do not stand out. */
static void an_empty_room_takes_no_fit(void **state)
{
    assert_int_equal(find_in_stored(*state, "none-nobody1", false), 0);
}

/* If all 18 or 19 bumps of this room were tried, a frame would take more than 200 fits. */
static void few_bumps_of_furniture_are_tried(void **state)
{
    assert_true(find_in_stored(*state, "none-nobody2", false) <= 150);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(every_stored_face_is_found, find_rig_new, find_rig_free),
        cmocka_unit_test_setup_teardown(a_scene_without_bumps_takes_no_fit, find_rig_new,
                                        find_rig_free),
        cmocka_unit_test_setup_teardown(an_empty_room_takes_no_fit, find_rig_new, find_rig_free),
        cmocka_unit_test_setup_teardown(few_bumps_of_furniture_are_tried, find_rig_new,
                                        find_rig_free),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
