/* Faces with a hidden part go through the whole pipeline. None of them is enrolled: either the
 * extraction refuses it, or the enrolment's own gate does. */
#include <stdio.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "drivers/base/times.h"
#include "drivers/recording/recording.h"
#include "firmware/config/enroll_options.h"
#include "firmware/recognise/pipeline.h"

enum { FACES = 4 };

/* The hidden part, as a rectangle about the nose tip in millimetres of the image, and the word that
 * would be a wrong hint. The subject's right is on the left of the image. */
static const struct cover {
    const char *name;
    double left, right, above, below;
    enum iso_capture wrong;
} covers[] = {
    {"right half", -130, 0, -170, 170, ISO_CAPTURE_COVERED_LEFT},
    {"left half", 0, 130, -170, 170, ISO_CAPTURE_COVERED_RIGHT},
    {"mouth and chin", -130, 130, 8, 170, ISO_CAPTURE_COVERED_EYES},
    {"eyes", -130, 130, -70, -15, ISO_CAPTURE_COVERED_MOUTH},
};

static struct iso_pipeline pipeline;
static struct iso_enroll_gate gate;

static int group_setup(void **state)
{
    const struct iso_config config = iso_config_default();
    const struct iso_pipeline_options options = {
        .head_path = ISOTHERM_SOURCE_DIR "/core/data/head.model",
        .method = ISO_METHOD_distance,
        .data_path = ISOTHERM_SOURCE_DIR "/core/data/cohort.templates",
        .extract = iso_extract_options_default(),
        .match = iso_match_options_default(),
        .clock = iso_times_system().monotonic,
    };
    (void)state;
    gate = iso_enroll_gate_of(&config.enroll);
    return iso_pipeline_open(&options, &pipeline, NULL);
}

static int group_teardown(void **state)
{
    (void)state;
    iso_pipeline_close(&pipeline);
    return 0;
}

/* Returns the enrolment's word for a frame. */
static enum iso_capture judge(const struct iso_frame *frame, struct iso_extraction *extraction)
{
    assert_int_equal(pipeline.ops->extract(pipeline.self, frame, "astra", extraction), 0);
    return extraction->outcome == ISO_CAPTURE_OK ? iso_enroll_gate_judge(&gate, extraction)
                                                 : extraction->outcome;
}

static void hide(struct iso_frame *frame, const struct iso_extraction *whole,
                 const struct cover *cover)
{
    double u, v;
    const double pitch_mm = whole->distance_mm / frame->camera.fx_px;
    assert_true(iso_camera_project(&frame->camera, whole->landmark_mm[ISO_LM_NOSE_TIP], &u, &v));
    for (int row = 0; row < frame->height_px; row++) {
        for (int column = 0; column < frame->width_px; column++) {
            const double right = (column - u) * pitch_mm, down = (row - v) * pitch_mm;
            if (right > cover->left && right < cover->right && down > cover->above &&
                down < cover->below) {
                frame->depth_mm[row * frame->width_px + column] = 0;
            }
        }
    }
}

static void look_at(const char *name, const struct cover *cover, int words[ISO_CAPTURES])
{
    struct iso_recording *recording = NULL;
    struct iso_frame *frame = NULL;
    static struct iso_extraction whole, covered;
    char path[256];
    (void)snprintf(path, sizeof path, ISOTHERM_SOURCE_DIR "/sim/stored/%s", name);
    assert_int_equal(iso_recording_open(path, &recording, NULL), 0);
    assert_int_equal(iso_recording_frame_new(recording, &frame), 0);
    assert_int_equal(iso_recording_read(recording, 0, frame, NULL), 0);
    assert_int_equal(judge(frame, &whole), ISO_CAPTURE_OK);
    hide(frame, &whole, cover);
    const enum iso_capture word = judge(frame, &covered);
    words[word]++;
    if (word == ISO_CAPTURE_OK || word == cover->wrong) {
        fail_msg("%s without its %s: %s", name, cover->name, iso_capture_name(word));
    }
    iso_frame_free(frame);
    iso_recording_close(recording);
}

static void a_covered_face_is_not_enrolled(void **state)
{
    static const char *const faces[FACES] = {"p01-enrol", "p02-enrol", "p05-enrol", "p08-enrol"};
    (void)state;
    for (size_t c = 0; c < sizeof covers / sizeof *covers; c++) {
        int words[ISO_CAPTURES] = {0};
        for (int i = 0; i < FACES; i++) {
            look_at(faces[i], &covers[c], words);
        }
        print_message("%-14s", covers[c].name);
        for (int w = 0; w < ISO_CAPTURES; w++) {
            if (words[w] > 0) {
                print_message(" %s %d", iso_capture_name((enum iso_capture)w), words[w]);
            }
        }
        print_message("\n");
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(a_covered_face_is_not_enrolled)};
    return cmocka_run_group_tests(tests, group_setup, group_teardown);
}
