/* The check of the image as a second opinion: its counts for the log, and the effects of off, flag
 * and veto. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "drivers/base/times.h"
#include "drivers/recording/recording.h"
#include "drivers/vision/face_detector.h"
#include "firmware/recognise/image_tally.h"
#include "tests/firmware/rigs/rig.h"
#include "tests/support/devices/painted_face.h"
#include "tests/support/scratch.h"

/* ---- counting ---- */

static void counts_the_results_of_images(void **state)
{
    struct iso_image_tally tally = {0};
    char text[ISO_IMAGE_TALLY_TEXT_SIZE] = "untouched";
    (void)state;
    iso_image_tally_take(&tally, ISO_FACE_NOT_CHECKED);
    iso_image_tally_take(&tally, ISO_FACE_NO_INTENSITY);
    assert_false(iso_image_tally_text(&tally, text));
    assert_string_equal(text, "untouched");
    for (int i = 0; i < 4; i++) {
        iso_image_tally_take(&tally, ISO_FACE_CONFIRMED);
    }
    iso_image_tally_take(&tally, ISO_FACE_ELSEWHERE);
    iso_image_tally_take(&tally, ISO_FACE_ABSENT);
    iso_image_tally_take(&tally, ISO_FACE_GRAINY);
    assert_true(iso_image_tally_text(&tally, text));
    assert_string_equal(text, "image: 4 confirmed, 2 contradicted, 1 unsure");
}

static void a_visit_is_logged_with_the_results_of_its_images(void **state)
{
    struct rig *rig = *state;
    rig_enrol(rig, "anna", 50);
    rig_start(rig);
    rig->puppet.seen = ISO_FACE_ELSEWHERE;
    rig_show(rig, 50, 2);
    rig_run(rig, 200);
    assert_non_null(strstr(rig_record(rig, "visit"),
                           "\"note\":\"image: 0 confirmed, 2 contradicted, 0 unsure\""));
    /* The next visit starts at zero. */
    rig_run(rig, 20000);
    rig->puppet.seen = ISO_FACE_CONFIRMED;
    rig_show(rig, 50, 2);
    rig_run(rig, 200);
    assert_non_null(strstr(rig_record(rig, "visit"),
                           "\"note\":\"image: 2 confirmed, 0 contradicted, 0 unsure\""));
}

static void a_visit_without_images_has_no_note(void **state)
{
    struct rig *rig = *state;
    rig_enrol(rig, "anna", 50);
    rig_start(rig);
    rig_show(rig, 50, 2);
    rig_run(rig, 200);
    assert_non_null(strstr(rig_record(rig, "visit"), "\"person\":\"anna\""));
    assert_null(strstr(rig_record(rig, "visit"), "\"note\""));
}

/* ---- the pipeline ---- */

static struct iso_pipeline_options options(enum iso_image_check image)
{
    return (struct iso_pipeline_options){
        .head_path = ISOTHERM_SOURCE_DIR "/core/data/head.model",
        .method = ISO_METHOD_distance,
        .data_path = ISOTHERM_SOURCE_DIR "/core/data/cohort.templates",
        .extract = iso_extract_options_default(),
        .match = iso_match_options_default(),
        .clock = iso_times_system().monotonic,
        .image = image,
    };
}

static struct iso_pipeline open_with(enum iso_image_check image)
{
    const struct iso_pipeline_options wanted = options(image);
    struct iso_pipeline pipeline = {0};
    struct iso_fault fault = {.text = ""};
    if (iso_pipeline_open(&wanted, &pipeline, &fault)) {
        fail_msg("%s", fault.text);
    }
    return pipeline;
}

/* A stored face with space for an image. */
static struct iso_frame *stored_face(void)
{
    struct iso_recording *recording = NULL;
    struct iso_frame *plain = NULL, *frame = NULL;
    assert_int_equal(iso_recording_open(ISOTHERM_SOURCE_DIR "/sim/stored/p02-v1", &recording, NULL),
                     0);
    assert_int_equal(iso_recording_frame_new(recording, &plain), 0);
    assert_int_equal(iso_recording_read(recording, 0, plain, NULL), 0);
    assert_int_equal(iso_frame_new(&plain->camera, plain->width_px, plain->height_px, true, &frame),
                     0);
    memcpy(frame->depth_mm, plain->depth_mm,
           (size_t)plain->width_px * (size_t)plain->height_px * sizeof *plain->depth_mm);
    iso_frame_free(plain);
    iso_recording_close(recording);
    return frame;
}

static struct iso_extraction extract(const struct iso_pipeline *pipeline,
                                     const struct iso_frame *frame)
{
    struct iso_extraction found;
    assert_int_equal(pipeline->ops->extract(pipeline->self, frame, "", &found), 0);
    return found;
}

static bool is_zero(const struct iso_template *tmpl)
{
    const struct iso_template zero = {0};
    return memcmp(tmpl, &zero, sizeof zero) == 0;
}

static void off_looks_at_no_image(void **state)
{
    struct iso_pipeline pipeline = open_with(ISO_IMAGE_OFF);
    struct iso_frame *frame = stored_face();
    (void)state;
    painted_blank(frame, 0.1);
    assert_int_equal(extract(&pipeline, frame).outcome, ISO_CAPTURE_OK);
    assert_int_equal(pipeline.ops->seen(pipeline.self), ISO_FACE_NOT_CHECKED);
    assert_string_equal(pipeline.ops->image_check(pipeline.self), "off");
    iso_frame_free(frame);
    iso_pipeline_close(&pipeline);
}

/* Checks the outcome and the result of the image check for a face without an image, for one whose
 * image shows it, for one whose image is evenly bright (outcome of_blank), and for an empty frame.
 */
static void look(enum iso_image_check image, enum iso_capture of_blank)
{
    struct iso_pipeline pipeline = open_with(image);
    struct iso_frame *frame = stored_face();
    float *intensity = frame->intensity;
    struct iso_extraction found;
    frame->intensity = NULL;
    found = extract(&pipeline, frame);
    assert_int_equal(found.outcome, ISO_CAPTURE_OK);
    assert_int_equal(pipeline.ops->seen(pipeline.self), ISO_FACE_NO_INTENSITY);
    frame->intensity = intensity;

    painted_face(frame, found.ibug_mm, 0.1);
    found = extract(&pipeline, frame);
    assert_int_equal(found.outcome, ISO_CAPTURE_OK);
    assert_int_equal(pipeline.ops->seen(pipeline.self), ISO_FACE_CONFIRMED);
    assert_false(is_zero(&found.tmpl));

    painted_blank(frame, 0.1);
    found = extract(&pipeline, frame);
    assert_int_equal(found.outcome, of_blank);
    assert_int_equal(pipeline.ops->seen(pipeline.self), ISO_FACE_ABSENT);
    assert_int_equal(is_zero(&found.tmpl), of_blank != ISO_CAPTURE_OK);

    memset(frame->depth_mm, 0,
           (size_t)frame->width_px * (size_t)frame->height_px * sizeof *frame->depth_mm);
    assert_int_equal(extract(&pipeline, frame).outcome, ISO_CAPTURE_NOBODY);
    assert_int_equal(pipeline.ops->seen(pipeline.self), ISO_FACE_NOT_CHECKED);
    iso_frame_free(frame);
    iso_pipeline_close(&pipeline);
}

static void flag_keeps_the_frame(void **state)
{
    (void)state;
    if (!*iso_face_detector_engine()) {
        skip();
    }
    look(ISO_IMAGE_FLAG, ISO_CAPTURE_OK);
}

static void veto_rejects_the_frame(void **state)
{
    (void)state;
    if (!*iso_face_detector_engine()) {
        skip();
    }
    look(ISO_IMAGE_VETO, ISO_CAPTURE_NO_FACE_IN_IMAGE);
}

/* If the configuration asks for the check and the module is missing, the pipeline opens all the
 * same, and says why there is no check. */
static void a_machine_without_the_module_runs(void **state)
{
    struct iso_pipeline pipeline = open_with(ISO_IMAGE_VETO);
    (void)state;
    assert_string_equal(pipeline.ops->image_check(pipeline.self),
                        *iso_face_detector_engine() ? "veto" : "absent");
    const char *lacks = pipeline.ops->image_lacks(pipeline.self);
    assert_true(*iso_face_detector_engine() ? *lacks == '\0'
                                            : strstr(lacks, "the package isotherm-vision") != NULL);
    iso_pipeline_close(&pipeline);
}

static void a_cascade_that_is_named_must_be_good(void **state)
{
    struct iso_pipeline_options wanted = options(ISO_IMAGE_FLAG);
    struct iso_pipeline pipeline = {0};
    struct iso_fault fault = {.text = ""};
    const bool built_in = *iso_face_detector_engine();
    (void)state;
    wanted.cascade_path = "/nonexistent/cascade.xml";
    assert_int_equal(iso_pipeline_open(&wanted, &pipeline, &fault), -ENOENT);
    assert_true(fault.text[0] != '\0');
    assert_null(pipeline.ops);
    wanted.cascade_path = wanted.head_path;
    assert_int_equal(iso_pipeline_open(&wanted, &pipeline, &fault), built_in ? -EBADMSG : -ENOENT);
    wanted.image = ISO_IMAGE_OFF; /* the file is not read */
    assert_int_equal(iso_pipeline_open(&wanted, &pipeline, &fault), 0);
    iso_pipeline_close(&pipeline);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(counts_the_results_of_images),
        cmocka_unit_test_setup_teardown(a_visit_is_logged_with_the_results_of_its_images, rig_setup,
                                        rig_teardown),
        cmocka_unit_test_setup_teardown(a_visit_without_images_has_no_note, rig_setup,
                                        rig_teardown),
        cmocka_unit_test(off_looks_at_no_image),
        cmocka_unit_test(flag_keeps_the_frame),
        cmocka_unit_test(veto_rejects_the_frame),
        cmocka_unit_test(a_machine_without_the_module_runs),
        cmocka_unit_test(a_cascade_that_is_named_must_be_good),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
