/* The check of a face's image: stored rendered people with and without a painted surface, and every
 * reason why the check has no result. All tests except `words` and the one of the cascade need the
 * module `vision`. */
#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "drivers/recording/recording.h"
#include "drivers/vision/face_check.h"
#include "drivers/vision/face_detector.h"
#include "isotherm/extract.h"
#include "tests/support/devices/painted_face.h"
#include "tests/support/scratch.h"

#define STORED ISOTHERM_SOURCE_DIR "/sim/stored/"
#define HEAD   ISOTHERM_SOURCE_DIR "/core/data/head.model"

static const char *const visits[] = {"p01-v1", "p02-v1", "p03-v2", "p04-v1", "p05-v1",
                                     "x01-v1", "x02-v2", "x03-v1", "x04-v1", "x05-v2"};
enum { VISITS = sizeof visits / sizeof *visits };

/* Faces that were found in stored frames, each with space for an image. */
struct faces {
    struct iso_head_model *head;
    struct iso_extractor *extractor;
    struct iso_frame *frame[VISITS];
    struct iso_extraction found[VISITS];
};

static struct faces faces;

static void read_face(int i)
{
    struct iso_recording *recording;
    struct iso_frame *plain;
    assert_int_equal(iso_recording_open(scratch_path(STORED, visits[i]), &recording, NULL), 0);
    assert_int_equal(iso_recording_frame_new(recording, &plain), 0);
    assert_int_equal(iso_recording_read(recording, 0, plain, NULL), 0);
    assert_int_equal(
        iso_frame_new(&plain->camera, plain->width_px, plain->height_px, true, &faces.frame[i]), 0);
    memcpy(faces.frame[i]->depth_mm, plain->depth_mm,
           (size_t)plain->width_px * (size_t)plain->height_px * sizeof *plain->depth_mm);
    assert_int_equal(iso_extractor_locate(faces.extractor, plain, &faces.found[i]), 0);
    assert_int_equal(faces.found[i].outcome, ISO_CAPTURE_OK);
    iso_frame_free(plain);
    iso_recording_close(recording);
}

static int find_faces(void **state)
{
    const struct iso_extract_options options = iso_extract_options_default();
    size_t size = 0;
    void *bytes = scratch_read(HEAD, &size);
    (void)state;
    assert_int_equal(iso_head_model_parse(bytes, size, &faces.head, NULL), 0);
    free(bytes);
    assert_int_equal(iso_extractor_new(faces.head, &options, &faces.extractor), 0);
    for (int i = 0; i < VISITS; i++) {
        read_face(i);
        painted_face(faces.frame[i], faces.found[i].ibug_mm, 0.1);
    }
    return 0;
}

static int forget_faces(void **state)
{
    (void)state;
    for (int i = 0; i < VISITS; i++) {
        iso_frame_free(faces.frame[i]);
    }
    iso_extractor_free(faces.extractor);
    iso_head_model_free(faces.head);
    return 0;
}

static struct iso_face_check *new_check(void)
{
    struct iso_face_check *check = NULL;
    struct iso_fault fault = {.text = ""};
    if (!*iso_face_detector_engine()) {
        skip();
    }
    if (iso_face_check_new("", &check, &fault)) {
        fail_msg("%s", fault.text);
    }
    return check;
}

/* Returns the check's result for a face whose pose and landmarks are shifted in the face's own
 * frame. */
static struct iso_face_checked ask_check(struct iso_face_check *check, int i,
                                         struct iso_vec3 aside_mm)
{
    struct iso_extraction at = faces.found[i];
    struct iso_face_checked checked;
    struct iso_vec3 by = iso_mat3_apply(&at.camera_from_face.rotation, aside_mm);
    at.camera_from_face.translation_mm = iso_add(at.camera_from_face.translation_mm, by);
    for (int l = 0; l < ISO_LANDMARKS; l++) {
        at.landmark_mm[l] = iso_add(at.landmark_mm[l], by);
    }
    assert_int_equal(
        iso_face_check_run(check, faces.frame[i], &at.camera_from_face, at.landmark_mm, &checked),
        0);
    return checked;
}

static const struct iso_vec3 here = {0.0, 0.0, 0.0};

static void words(void **state)
{
    (void)state;
    for (int seen = 0; seen < ISO_FACE_SEEN; seen++) {
        assert_non_null(iso_face_seen_name((enum iso_face_seen)seen));
        for (int other = 0; other < seen; other++) {
            assert_string_not_equal(iso_face_seen_name((enum iso_face_seen)seen),
                                    iso_face_seen_name((enum iso_face_seen)other));
        }
    }
    assert_null(iso_face_seen_name(ISO_FACE_SEEN));
    assert_string_equal(iso_face_seen_name(ISO_FACE_ELSEWHERE), "elsewhere");
    assert_true(iso_face_seen_disagrees(ISO_FACE_ELSEWHERE));
    assert_true(iso_face_seen_disagrees(ISO_FACE_ABSENT));
    assert_false(iso_face_seen_disagrees(ISO_FACE_CONFIRMED));
    assert_false(iso_face_seen_disagrees(ISO_FACE_NOT_CHECKED));
    assert_false(iso_face_seen_disagrees(ISO_FACE_GRAINY));
}

static void faces_are_confirmed(void **state)
{
    struct iso_face_check *check = new_check();
    (void)state;
    for (int i = 0; i < VISITS; i++) {
        const struct iso_face_checked checked = ask_check(check, i, here);
        print_message("%s: %s, %.1f mm off, %.0f mm wide, %d votes\n", visits[i],
                      iso_face_seen_name(checked.seen), checked.offset_mm, checked.side_mm,
                      checked.votes);
        assert_int_equal(checked.seen, ISO_FACE_CONFIRMED);
        assert_in_range(checked.side_mm, 120, 220);
        assert_true(checked.votes >= 2);
    }
    iso_face_check_free(check);
}

/* The landmarks are 35 mm beside, above and below their true places. */
static void wrong_landmarks_are_contradicted(void **state)
{
    struct iso_face_check *check = new_check();
    const struct iso_vec3 aside[] = {{35, 0, 0}, {-35, 0, 0}, {0, 35, 0}, {0, -35, 0}};
    (void)state;
    for (int i = 0; i < VISITS; i++) {
        for (int k = 0; k < 4; k++) {
            const struct iso_face_checked checked = ask_check(check, i, aside[k]);
            if (!iso_face_seen_disagrees(checked.seen)) {
                fail_msg("%s, aside %d: %s, %.1f mm", visits[i], k,
                         iso_face_seen_name(checked.seen), checked.offset_mm);
            }
        }
    }
    iso_face_check_free(check);
}

static void a_face_without_markings_is_none(void **state)
{
    struct iso_face_check *check = new_check();
    (void)state;
    for (int i = 0; i < VISITS; i++) {
        painted_blank(faces.frame[i], 0.1);
        const struct iso_face_checked checked = ask_check(check, i, here);
        painted_face(faces.frame[i], faces.found[i].ibug_mm, 0.1);
        assert_int_equal(checked.seen, ISO_FACE_ABSENT);
        assert_int_equal(checked.votes, 0);
    }
    iso_face_check_free(check);
}

/* The check draws its picture straight from the front, so that a head that lies on its side gives
 * the same result. */
static void a_tilted_head_is_confirmed(void **state)
{
    struct iso_face_check *check = new_check();
    struct iso_frame *upright = faces.frame[0], *lying;
    struct iso_face_checked checked;
    const struct iso_mat3 quarter = iso_mat3_rotation(iso_vec3(0.0, 0.0, 1.5707963267948966));
    struct iso_extraction at = faces.found[0];
    struct iso_camera camera = upright->camera;
    const int w = upright->width_px, h = upright->height_px;
    (void)state;
    /* (u, v) -> (h - 1 - v, u): x -> -y, y -> x. */
    camera.width_px = h;
    camera.height_px = w;
    camera.fx_px = upright->camera.fy_px;
    camera.fy_px = upright->camera.fx_px;
    camera.cx_px = h - 1 - upright->camera.cy_px;
    camera.cy_px = upright->camera.cx_px;
    assert_int_equal(iso_frame_new(&camera, h, w, true, &lying), 0);
    for (int row = 0; row < h; row++) {
        for (int column = 0; column < w; column++) {
            size_t to = (size_t)column * (size_t)h + (size_t)(h - 1 - row);
            lying->depth_mm[to] = upright->depth_mm[row * w + column];
            lying->intensity[to] = upright->intensity[row * w + column];
        }
    }
    const struct iso_rigid turn = {quarter, {0.0, 0.0, 0.0}};
    at.camera_from_face = iso_rigid_mul(&turn, &at.camera_from_face);
    for (int l = 0; l < ISO_LANDMARKS; l++) {
        at.landmark_mm[l] = iso_rigid_apply(&turn, at.landmark_mm[l]);
    }
    assert_int_equal(
        iso_face_check_run(check, lying, &at.camera_from_face, at.landmark_mm, &checked), 0);
    assert_int_equal(checked.seen, ISO_FACE_CONFIRMED);
    iso_frame_free(lying);
    iso_face_check_free(check);
}

/* ---- no result ---- */

static void without_an_image(void **state)
{
    struct iso_face_check *check = new_check();
    float *image = faces.frame[1]->intensity;
    (void)state;
    faces.frame[1]->intensity = NULL;
    const struct iso_face_checked checked = ask_check(check, 1, here);
    faces.frame[1]->intensity = image;
    assert_int_equal(checked.seen, ISO_FACE_NO_INTENSITY);
    iso_face_check_free(check);
}

static void turned_too_far(void **state)
{
    struct iso_face_check *check = new_check();
    struct iso_extraction at = faces.found[1];
    struct iso_mat3 turn = iso_mat3_rotation(iso_vec3(0.0, 0.9, 0.0));
    struct iso_face_checked checked;
    (void)state;
    at.camera_from_face.rotation = iso_mat3_mul(&at.camera_from_face.rotation, &turn);
    assert_int_equal(
        iso_face_check_run(check, faces.frame[1], &at.camera_from_face, at.landmark_mm, &checked),
        0);
    assert_int_equal(checked.seen, ISO_FACE_TURNED);
    iso_face_check_free(check);
}

static size_t pixels(const struct iso_frame *frame)
{
    return (size_t)frame->width_px * (size_t)frame->height_px;
}

static void an_unmeasured_face_is_hidden(void **state)
{
    struct iso_face_check *check = new_check();
    struct iso_frame *frame = faces.frame[2];
    double u = 0.0, v = 0.0;
    (void)state;
    assert_true(
        iso_camera_project(&frame->camera, faces.found[2].camera_from_face.translation_mm, &u, &v));
    for (int row = 0; row < (int)v; row++) { /* all pixels above the nose tip: a cap, or the sun */
        memset(frame->depth_mm + row * frame->width_px, 0,
               (size_t)frame->width_px * sizeof *frame->depth_mm);
    }
    assert_int_equal(ask_check(check, 2, here).seen, ISO_FACE_HIDDEN);
    memset(frame->depth_mm, 0, pixels(frame) * sizeof *frame->depth_mm);
    assert_int_equal(ask_check(check, 2, here).seen, ISO_FACE_HIDDEN);
    iso_frame_free(frame);
    read_face(2);
    painted_face(faces.frame[2], faces.found[2].ibug_mm, 0.1);
    iso_face_check_free(check);
}

static void in_a_bad_light(void **state)
{
    struct iso_face_check *check = new_check();
    struct iso_frame *frame = faces.frame[3];
    uint64_t random = 88172645463325252U;
    (void)state;
    painted_face(frame, faces.found[3].ibug_mm, 0.003);
    assert_int_equal(ask_check(check, 3, here).seen, ISO_FACE_DARK);
    painted_face(frame, faces.found[3].ibug_mm, 5.0);
    assert_int_equal(ask_check(check, 3, here).seen, ISO_FACE_GLARING);
    painted_face(frame, faces.found[3].ibug_mm, 0.1);
    for (size_t i = 0; i < pixels(frame); i++) { /* dots: xorshift (Marsaglia 2003) */
        random ^= random << 13;
        random ^= random >> 7;
        random ^= random << 17;
        frame->intensity[i] *= random % 8 == 0 ? 4.0F : 0.6F;
    }
    assert_int_equal(ask_check(check, 3, here).seen, ISO_FACE_GRAINY);
    painted_face(frame, faces.found[3].ibug_mm, 0.1);
    iso_face_check_free(check);
}

/* ---- errors ---- */

static void an_invalid_cascade_is_refused(void **state)
{
    struct iso_face_check *check = NULL;
    struct iso_fault fault = {.text = ""};
    (void)state;
    if (!*iso_face_detector_engine()) {
        assert_int_equal(iso_face_check_new("", &check, &fault), -ENOENT);
        assert_non_null(strstr(fault.text, "is missing: install the package isotherm-vision"));
        assert_string_equal(iso_face_detector_cascade(), "");
        assert_null(check);
        return;
    }
    assert_int_equal(iso_face_check_new("/nonexistent/cascade.xml", &check, &fault), -ENOENT);
    assert_string_equal(fault.text, "/nonexistent/cascade.xml: No such file or directory");
    assert_int_equal(iso_face_check_new(HEAD, &check, &fault), -EBADMSG);
    assert_non_null(strstr(fault.text, "head.model: not a cascade that OpenCV can read"));
    assert_int_equal(iso_face_check_new("/", &check, &fault), -EISDIR);
    assert_null(check);
    iso_face_check_free(NULL);
}

static void the_detector_refuses_impossible_sizes(void **state)
{
    static const uint8_t black[40 * 30];
    struct iso_face_detector *detector = NULL;
    struct iso_face_box box = {.votes = -7};
    (void)state;
    if (!*iso_face_detector_engine()) {
        skip();
    }
    assert_int_equal(iso_face_detector_new(iso_face_detector_cascade(), &detector, NULL), 0);
    assert_int_equal(iso_face_detector_find(detector, black, 0, 30, 20, 30, &box), -EINVAL);
    assert_int_equal(iso_face_detector_find(detector, black, 40, 9000, 20, 30, &box), -EINVAL);
    assert_int_equal(iso_face_detector_find(detector, black, 40, 30, 0, 30, &box), -EINVAL);
    assert_int_equal(iso_face_detector_find(detector, black, 40, 30, 30, 20, &box), -EINVAL);
    assert_int_equal(box.votes, -7);
    assert_int_equal(iso_face_detector_find(detector, black, 40, 30, 20, 30, &box), 0);
    assert_int_equal(box.votes, 0);
    iso_face_detector_free(detector);
    iso_face_detector_free(NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(words),
        cmocka_unit_test(faces_are_confirmed),
        cmocka_unit_test(wrong_landmarks_are_contradicted),
        cmocka_unit_test(a_face_without_markings_is_none),
        cmocka_unit_test(a_tilted_head_is_confirmed),
        cmocka_unit_test(without_an_image),
        cmocka_unit_test(turned_too_far),
        cmocka_unit_test(an_unmeasured_face_is_hidden),
        cmocka_unit_test(in_a_bad_light),
        cmocka_unit_test(an_invalid_cascade_is_refused),
        cmocka_unit_test(the_detector_refuses_impossible_sizes),
    };
    return cmocka_run_group_tests(tests, find_faces, forget_faces);
}
