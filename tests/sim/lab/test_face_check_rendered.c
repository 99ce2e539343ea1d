/* The result of the image check for rendered people, for busts without markings and for prints,
 * before a Kinect v2. The test needs the head model's data (ISOTHERM_SHARED/data/ict-face) and a
 * build with OpenCV. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "drivers/vision/face_check.h"
#include "drivers/vision/face_detector.h"
#include "sim/world/face/expression.h"
#include "sim/world/prop/print.h"
#include "sim/world/scene/portrait.h"
#include "sim/world/sensor/sensor.h"
#include "tests/support/scratch.h"
#include "tests/support/shared_data.h"

enum { PEOPLE = 24 };

struct bench {
    struct sim_ict *ict;
    struct sim_view *view;
    struct sim_sensor_workspace *workspace;
    struct iso_frame *frame;
    struct iso_face_check *check;
};

static const struct sim_sensor *const sensor = &sim_sensor_kinect2;

static struct bench set_up(void)
{
    const char *path = shared_data("data/ict-face");
    struct bench b = {.ict = NULL};
    if (!scratch_exists(path) || !*iso_face_detector_engine()) {
        skip();
    }
    assert_int_equal(sim_ict_load(path, &b.ict, NULL), 0);
    assert_int_equal(sim_view_new(&sensor->camera, sensor->supersample, &b.view), 0);
    assert_int_equal(sim_sensor_workspace_new(sensor, &b.workspace), 0);
    assert_int_equal(iso_frame_new(&sensor->camera, sensor->camera.width_px,
                                   sensor->camera.height_px, true, &b.frame),
                     0);
    assert_int_equal(iso_face_check_new("", &b.check, NULL), 0);
    return b;
}

static void tear_down(struct bench *b)
{
    iso_face_check_free(b->check);
    iso_frame_free(b->frame);
    sim_sensor_workspace_free(b->workspace);
    sim_view_free(b->view);
    sim_ict_free(b->ict);
}

static void shoot(struct bench *b, uint64_t seed)
{
    struct sim_random random = sim_random_seeded(seed, 0, 0);
    sim_view_finish(b->view);
    sim_sensor_measure(sensor, b->view, 1.0, &random, b->workspace, b->frame);
    sim_infrared_measure(sensor, b->view, 1.0, &random, b->workspace, b->frame->intensity);
}

/* A person with an expression, turned a little. The landmarks have errors in x and y with a
 * standard deviation of 1.5 mm. */
static struct iso_face_checked visit(struct bench *b, uint32_t index, bool blank)
{
    struct sim_person person = sim_person_draw(SIM_POPULATION_TEST, 31, index, 1.0);
    struct sim_random random = sim_random_seeded(person.key, 7, 0);
    struct sim_sitter_options options = {.hair = true, .torso = true, .blank = blank};
    struct sim_stance stance = {.yaw_rad = sim_random_between(&random, -0.4, 0.4),
                                .pitch_rad = sim_random_between(&random, -0.25, 0.25),
                                .roll_rad = sim_random_between(&random, -0.3, 0.3),
                                .nose_mm = {sim_random_between(&random, -60.0, 60.0), 10.0,
                                            sim_random_between(&random, 700.0, 1000.0)}};
    struct iso_face_checked checked;
    struct sim_sitter *sitter;
    struct sim_truth truth;
    (void)sim_expression_draw(b->ict, SIM_STRONG, &random, stance.expression);
    assert_int_equal(sim_sitter_new(b->ict, &person, &options, &random, &sitter), 0);
    sim_view_clear(b->view);
    assert_int_equal(sim_sitter_draw(sitter, &stance, b->view, &truth), 0);
    shoot(b, index);
    for (int l = 0; l < ISO_LANDMARKS; l++) {
        truth.landmark_mm[l].x += 1.5 * sim_random_normal(&random);
        truth.landmark_mm[l].y += 1.5 * sim_random_normal(&random);
    }
    assert_int_equal(iso_face_check_run(b->check, b->frame, &truth.camera_from_face,
                                        truth.landmark_mm, &checked),
                     0);
    sim_sitter_free(sitter);
    return checked;
}

static void people_are_confirmed(void **state)
{
    struct bench b = set_up();
    int confirmed = 0;
    double most_mm = 0.0;
    (void)state;
    for (uint32_t i = 0; i < PEOPLE; i++) {
        const struct iso_face_checked checked = visit(&b, i, false);
        confirmed += checked.seen == ISO_FACE_CONFIRMED;
        most_mm = fmax(most_mm, checked.offset_mm);
    }
    print_message("%d of %d confirmed, at most %.1f mm off\n", confirmed, PEOPLE, most_mm);
    assert_true(confirmed >= PEOPLE - 1);
    tear_down(&b);
}

/* face_check.h states this limit: a head of one albedo still looks like a face, by its shading
 * alone. A better check has to change this test and that comment. */
static void a_bust_looks_like_a_face(void **state)
{
    struct bench b = set_up();
    int noticed = 0;
    (void)state;
    for (uint32_t i = 0; i < PEOPLE; i++) {
        noticed += iso_face_seen_disagrees(visit(&b, i, true).seen);
    }
    print_message("%d of %d noticed\n", noticed, PEOPLE);
    assert_true(2 * noticed < PEOPLE);
    tear_down(&b);
}

/* A life-size print at 700 mm, bent about a vertical axis, in the place of a face. */
static enum iso_face_seen show_print(struct bench *b, const float *albedo)
{
    const struct iso_vec3 nose = {0.0, 10.0, 700.0};
    const struct sim_stance ahead = {.nose_mm = nose};
    const struct iso_rigid camera_from_face = sim_stance_camera_from_face(&ahead);
    const struct iso_rigid placed = {iso_mat3_identity(), {0.0, 0.0, 700.0}};
    struct iso_vec3 landmark_mm[ISO_LANDMARKS];
    struct iso_face_checked checked;
    struct sim_solid *sheet;
    assert_int_equal(sim_print_new(SIM_PORTRAIT_COLUMNS, SIM_PORTRAIT_ROWS, 150.0, albedo,
                                   SIM_PORTRAIT_COLUMNS, SIM_PORTRAIT_ROWS, &sheet),
                     0);
    struct iso_vec3 *scratch = malloc(sheet->n_vertices * sizeof *scratch);
    assert_non_null(scratch);
    sim_view_clear(b->view);
    assert_int_equal(sim_solid_draw(sheet, &placed, scratch, b->view), 0);
    shoot(b, 1);
    for (int l = 0; l < ISO_LANDMARKS; l++) { /* their mean counts: just above the nose */
        landmark_mm[l] = iso_vec3(0.0, 10.0, 700.0);
    }
    assert_int_equal(
        iso_face_check_run(b->check, b->frame, &camera_from_face, landmark_mm, &checked), 0);
    free(scratch);
    sim_solid_free(sheet);
    return checked.seen;
}

/* Ink that is transparent to infrared light gives the image of plain paper. The check takes a print
 * with visible ink for a face; only the depth image shows that it is flat. */
static void prints_are_as_good_as_their_ink(void **state)
{
    struct bench b = set_up();
    struct sim_sitter_options options = {.hair = true};
    float *portrait = malloc(SIM_PORTRAIT_COLUMNS * SIM_PORTRAIT_ROWS * sizeof *portrait);
    (void)state;
    assert_non_null(portrait);
    for (uint32_t i = 0; i < 4; i++) {
        struct sim_person person = sim_person_draw(SIM_POPULATION_TEST, 32, i, 1.0);
        struct sim_random random = sim_random_seeded(1, 0, i);
        struct sim_sitter *sitter;
        assert_int_equal(sim_sitter_new(b.ict, &person, &options, &random, &sitter), 0);
        assert_int_equal(sim_portrait(sitter, portrait), 0);
        assert_int_equal(show_print(&b, portrait), ISO_FACE_CONFIRMED);
        sim_sitter_free(sitter);
    }
    assert_int_equal(show_print(&b, NULL), ISO_FACE_ABSENT);
    free(portrait);
    tear_down(&b);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(people_are_confirmed),
        cmocka_unit_test(a_bust_looks_like_a_face),
        cmocka_unit_test(prints_are_as_good_as_their_ink),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
