/* The whole way from a frame to a template: outcomes and hints on rendered heads, where the truth
 * is known, and on the stored frames. */
#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "core/extract/extract.h"
#include "core/heat/grid/grid_stencil.h"
#include "core/match/distance.h"
#include "drivers/recording/recording.h"
#include "tests/core/surfaces/rendered_head.h"
#include "tests/core/surfaces/shipped_model.h"

/* What registrations work in. */
static struct iso_icp_workspace registration;

struct fixture {
    struct iso_head_model *model;
    struct iso_extract_options options;
    struct iso_extractor *extractor;
    struct iso_frame *frame;
    struct iso_extraction out;
};

static int set_up(void **state)
{
    struct fixture *f = calloc(1, sizeof *f);
    assert_non_null(f);
    f->model = shipped_head_model();
    f->options = iso_extract_options_default();
    f->frame = rendered_head_frame();
    assert_int_equal(iso_extractor_new(f->model, &f->options, &f->extractor), 0);
    *state = f;
    return 0;
}

static int tear_down(void **state)
{
    struct fixture *f = *state;
    iso_extractor_free(f->extractor);
    iso_head_model_free(f->model);
    iso_frame_free(f->frame);
    free(f);
    return 0;
}

static void draw_mean(struct fixture *f, double yaw_deg, double pitch_deg, struct iso_vec3 nose_mm)
{
    struct iso_rigid pose = rendered_head_pose(yaw_deg, pitch_deg, nose_mm);
    for (int i = 0; i < f->frame->width_px * f->frame->height_px; i++) {
        f->frame->depth_mm[i] = 0.0f;
    }
    rendered_head_draw(f->frame, f->model, NULL, 1.0, &pose);
}

static enum iso_capture run(struct fixture *f)
{
    assert_int_equal(iso_extractor_run(f->extractor, f->frame, &f->out), 0);
    return f->out.outcome;
}

static enum iso_capture outcome_of_mean(struct fixture *f, double yaw_deg, double pitch_deg,
                                        struct iso_vec3 nose_mm)
{
    draw_mean(f, yaw_deg, pitch_deg, nose_mm);
    return run(f);
}

static void the_mean_head_gives_its_pose_landmarks_and_template(void **state)
{
    struct fixture *f = *state;
    struct iso_rigid truth = rendered_head_pose(14.0, -8.0, iso_vec3(-30, 20, 640));
    assert_int_equal(outcome_of_mean(f, 14.0, -8.0, iso_vec3(-30, 20, 640)), ISO_CAPTURE_OK);
    const struct iso_extraction *out = &f->out;
    rendered_head_assert_pose(&out->camera_from_face, &truth, 1.0, 1.0);
    assert_true(fabs(out->yaw_rad * 180.0 / M_PI - 14.0) < 1.0);
    assert_true(fabs(out->pitch_rad * 180.0 / M_PI + 8.0) < 1.0);
    assert_true(fabs(out->roll_rad) * 180.0 / M_PI < 3.0);
    assert_true(fabs(out->distance_mm - 640.0) < 1.0);
    assert_true(out->residual_mm >= 0.0 && out->residual_mm < 2.0);
    assert_true(out->coverage > 0.8 && out->coverage <= 1.0);
    for (int l = 0; l < ISO_LANDMARKS; l++) {
        struct iso_vec3 at = iso_head_point_on(f->model, f->model->mean_mm,
                                               f->model->landmarks[iso_landmark_ibug[l]]);
        at = iso_rigid_apply(&truth, at);
        assert_true(iso_norm(iso_sub(out->landmark_mm[l], at)) < 3.0);
    }
    assert_int_equal(out->tmpl.algorithm, iso_extractor_algorithm(f->extractor));
    assert_int_equal(out->tmpl.n_radii, 4);
    assert_int_equal(out->tmpl.n_points, 16);
    assert_int_equal(out->tmpl.n_frames, 1);
    assert_true(out->tmpl.radius_mm[0] == 12.0f && out->tmpl.radius_mm[3] == 36.0f);
    assert_true(out->tmpl.quality > 0.8f && out->tmpl.quality <= 1.0f);
    uint8_t bytes[ISO_TEMPLATE_BYTES_MAX];
    assert_true(iso_template_serialise(&out->tmpl, bytes, sizeof bytes) > 0);
}

static void hints_say_where_to_stand(void **state)
{
    struct fixture *f = *state;
    assert_int_equal(outcome_of_mean(f, 0, 0, iso_vec3(0, 0, 600)), ISO_CAPTURE_OK);
    assert_int_equal(outcome_of_mean(f, 0, 0, iso_vec3(10, 0, 1700)), ISO_CAPTURE_TOO_FAR);
    assert_int_equal(outcome_of_mean(f, 0, 0, iso_vec3(0, 0, 265)), ISO_CAPTURE_TOO_CLOSE);
    assert_int_equal(outcome_of_mean(f, 0, 0, iso_vec3(0, 0, 3000)), ISO_CAPTURE_NOBODY);
    /* Half out of the image at the right, at the top, at the left and at the bottom. */
    assert_int_equal(outcome_of_mean(f, 0, 0, iso_vec3(344, 0, 600)), ISO_CAPTURE_MOVE_RIGHT);
    assert_int_equal(outcome_of_mean(f, 0, 0, iso_vec3(0, -263, 600)), ISO_CAPTURE_MOVE_DOWN);
    assert_int_equal(outcome_of_mean(f, 0, 0, iso_vec3(-344, 0, 600)), ISO_CAPTURE_MOVE_LEFT);
    assert_int_equal(outcome_of_mean(f, 0, 0, iso_vec3(0, 263, 600)), ISO_CAPTURE_MOVE_UP);
}

/* Who is turned to his or her left should turn to the right, and so on. A half turn is the limit of
 * what is looked for at all, so that the limit is lowered. */
static void hints_say_where_to_look(void **state)
{
    struct fixture *f = *state;
    struct iso_vec3 at = {0, 0, 600};
    iso_extractor_free(f->extractor);
    f->extractor = NULL;
    f->options.yaw_max_rad = 20.0 * M_PI / 180.0;
    f->options.pitch_max_rad = 15.0 * M_PI / 180.0;
    assert_int_equal(iso_extractor_new(f->model, &f->options, &f->extractor), 0);
    assert_int_equal(outcome_of_mean(f, 17, -12, at), ISO_CAPTURE_OK);
    assert_int_equal(outcome_of_mean(f, -17, 12, at), ISO_CAPTURE_OK);
    assert_int_equal(outcome_of_mean(f, 30, 0, at), ISO_CAPTURE_TURN_RIGHT);
    assert_true(f->out.yaw_rad > 0.0);
    assert_int_equal(outcome_of_mean(f, -30, 0, at), ISO_CAPTURE_TURN_LEFT);
    assert_true(f->out.yaw_rad < 0.0);
    assert_int_equal(outcome_of_mean(f, 0, 25, at), ISO_CAPTURE_LOOK_DOWN);
    assert_true(f->out.pitch_rad > 0.0);
    assert_int_equal(outcome_of_mean(f, 0, -25, at), ISO_CAPTURE_LOOK_UP);
    assert_true(f->out.pitch_rad < 0.0);
}

/* The subject's left is the camera's right: said once more without the pose's own convention. */
static void the_subjects_left_is_the_images_right(void **state)
{
    struct fixture *f = *state;
    assert_int_equal(outcome_of_mean(f, 25, 0, iso_vec3(0, 0, 600)), ISO_CAPTURE_OK);
    const struct iso_vec3 *at = f->out.landmark_mm;
    assert_true(at[ISO_LM_EYE_OUT_L].x > at[ISO_LM_EYE_OUT_R].x);
    assert_true(at[ISO_LM_MOUTH_L].y > at[ISO_LM_EYE_OUT_L].y); /* y points down */
    /* Turned to the left, the left eye is the farther one. */
    assert_true(at[ISO_LM_EYE_OUT_L].z > at[ISO_LM_EYE_OUT_R].z + 10.0);
}

/* Nothing at all, a wall before the camera, and one behind the range of use. */
static void an_empty_scene_is_nobody(void **state)
{
    struct fixture *f = *state;
    assert_int_equal(run(f), ISO_CAPTURE_NOBODY);
    rendered_head_wall(f->frame, 800.0f);
    assert_int_equal(run(f), ISO_CAPTURE_NOBODY);
    rendered_head_wall(f->frame, 1700.0f);
    assert_int_equal(run(f), ISO_CAPTURE_NOBODY);
    assert_int_equal(f->out.tmpl.n_points, 0);
}

/* A face of which its right half is hidden, nose and all. */
/* With the nose tip goes what a face is looked for by: it is not found, or found to be half there.
 */
static void a_hidden_half_has_no_template(void **state)
{
    struct fixture *f = *state;
    draw_mean(f, 0, 0, iso_vec3(0, 0, 600));
    for (int row = 0; row < 480; row++) {
        memset(&f->frame->depth_mm[row * 640], 0, 320 * sizeof(float)); /* the nose: column 310 */
    }
    enum iso_capture outcome = run(f);
    assert_true(outcome == ISO_CAPTURE_TOO_FEW_POINTS || outcome == ISO_CAPTURE_COVERED_RIGHT ||
                outcome == ISO_CAPTURE_NOT_A_FACE);
    assert_int_equal(f->out.tmpl.n_points, 0);
}

static void the_same_frame_gives_the_same_template(void **state)
{
    struct fixture *f = *state;
    assert_int_equal(outcome_of_mean(f, 5, 5, iso_vec3(0, 0, 600)), ISO_CAPTURE_OK);
    struct iso_extraction first = f->out;
    assert_int_equal(run(f), ISO_CAPTURE_OK);
    assert_memory_equal(&first, &f->out, sizeof first);
    /* Nor does it matter who was there in between, or that it is another extractor. */
    assert_int_equal(outcome_of_mean(f, -20, 0, iso_vec3(60, 0, 900)), ISO_CAPTURE_OK);
    assert_memory_not_equal(&first.tmpl, &f->out.tmpl, sizeof first.tmpl);
    rendered_head_wall(f->frame, 250.0f);
    (void)run(f);
    assert_int_equal(outcome_of_mean(f, 5, 5, iso_vec3(0, 0, 600)), ISO_CAPTURE_OK);
    assert_memory_equal(&first, &f->out, sizeof first);
    struct iso_extractor *other = NULL;
    assert_int_equal(iso_extractor_new(f->model, &f->options, &other), 0);
    assert_int_equal(iso_extractor_run(other, f->frame, &f->out), 0);
    assert_memory_equal(&first, &f->out, sizeof first);
    iso_extractor_free(other);
}

/* The fixture's frame by another extractor, and how far its template lies from the first one's. */
static double distance_of_method(struct fixture *f, enum iso_heat_method method)
{
    struct iso_template first = f->out.tmpl;
    struct iso_extractor *other = NULL;
    f->options.heat = method;
    assert_int_equal(iso_extractor_new(f->model, &f->options, &other), 0);
    assert_int_not_equal(iso_extractor_algorithm(other), first.algorithm);
    assert_int_equal(iso_extractor_run(other, f->frame, &f->out), 0);
    assert_int_equal(f->out.outcome, ISO_CAPTURE_OK);
    f->out.tmpl.algorithm = first.algorithm; /* they must not be compared but by a test */
    const struct iso_match_options options = iso_match_options_default();
    double distance_mm = INFINITY;
    assert_int_equal(
        iso_match_distance(&registration, &f->out.tmpl, &first, &options, &distance_mm), 0);
    iso_extractor_free(other);
    return distance_mm;
}

static void all_ways_to_the_heat_agree(void **state)
{
    struct fixture *f = *state;
    assert_int_equal(outcome_of_mean(f, 0, 0, iso_vec3(0, 0, 600)), ISO_CAPTURE_OK);
    struct iso_template grid = f->out.tmpl;
    assert_true(distance_of_method(f, ISO_HEAT_DIRECT) < 0.2); /* lumped and consistent mass */
    f->out.tmpl = grid;
    assert_true(distance_of_method(f, ISO_HEAT_SPECTRAL) < 1.0);
    assert_string_equal(iso_heat_method_name(ISO_HEAT_GRID), "grid");
    assert_string_equal(iso_heat_method_name(ISO_HEAT_SPECTRAL), "spectral");
    assert_null(iso_heat_method_name((enum iso_heat_method)3));
}

/* So fine a grid and so long a time that the expansion is not worth it. */
static void heat_too_stiff_for_the_grid_is_released_on_the_mesh(void **state)
{
    struct fixture *f = *state;
    iso_extractor_free(f->extractor);
    f->extractor = NULL;
    f->options.spacing_mm = 0.7;
    f->options.crop_radius_mm = 80.0;
    f->options.t_mm2 = 200.0;
    assert_int_equal(iso_extractor_new(f->model, &f->options, &f->extractor), 0);
    assert_int_equal(outcome_of_mean(f, 0, 0, iso_vec3(0, 0, 600)), ISO_CAPTURE_OK);
    assert_true(iso_extractor_mesh(f->extractor)->n_triangles > 50000);
    assert_true(f->out.tmpl.quality > 0.9f);
    assert_true(distance_of_method(f, ISO_HEAT_DIRECT) < 0.2);
}

static void the_mesh_and_its_heat_can_be_shown(void **state)
{
    struct fixture *f = *state;
    assert_int_equal(outcome_of_mean(f, 0, 0, iso_vec3(0, 0, 600)), ISO_CAPTURE_OK);
    const struct iso_mesh *mesh = iso_extractor_mesh(f->extractor);
    assert_int_equal(iso_mesh_check(mesh, NULL), 0);
    for (int l = 0; l < ISO_LANDMARKS; l++) {
        const double *heat = iso_extractor_heat(f->extractor, (enum iso_landmark)l);
        int32_t hottest = 0;
        for (int32_t i = 1; i < mesh->n_vertices; i++) {
            hottest = heat[i] > heat[hottest] ? i : hottest;
        }
        struct iso_vec3 at = iso_rigid_apply(&f->out.camera_from_face, mesh->vertices_mm[hottest]);
        /* A vertex or two away; beside the nose, where the grid is steep, that is far. */
        double off_mm = iso_norm(iso_sub(at, f->out.landmark_mm[l]));
        assert_true(off_mm < (l == ISO_LM_ALA_R || l == ISO_LM_ALA_L ? 12.0 : 3.0));
    }
}

static int64_t tick(void *context)
{
    return ++*(int64_t *)context;
}

static void stages_are_charged_by_the_clock_handed_in(void **state)
{
    struct fixture *f = *state;
    int64_t ticks = 0;
    struct iso_extractor *timed = NULL;
    f->options.now_ns = tick;
    f->options.now_context = &ticks;
    assert_int_equal(iso_extractor_new(f->model, &f->options, &timed), 0);
    draw_mean(f, 0, 0, iso_vec3(0, 0, 600));
    assert_int_equal(iso_extractor_run(timed, f->frame, &f->out), 0);
    for (int s = 0; s < ISO_STAGES; s++) {
        assert_int_equal(f->out.stage_ns[s], 1);
        assert_non_null(iso_stage_name((enum iso_stage)s));
    }
    draw_mean(f, 0, 0, iso_vec3(0, 0, 3000)); /* ends at the first stage */
    assert_int_equal(iso_extractor_run(timed, f->frame, &f->out), 0);
    assert_int_equal(f->out.stage_ns[ISO_STAGE_REGION], 1);
    assert_int_equal(f->out.stage_ns[ISO_STAGE_CLEAN], 0);
    assert_null(iso_stage_name(ISO_STAGES));
    iso_extractor_free(timed);
}

static void bad_options_are_refused(void **state)
{
    struct fixture *f = *state;
    struct iso_extract_options bad[23];
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        bad[i] = f->options;
    }
    bad[0].t_mm2 = 0.0;
    bad[1].t_mm2 = NAN;
    bad[2].n_radii = 0;
    bad[3].n_radii = ISO_TEMPLATE_RADII_MAX + 1;
    bad[4].radius_mm[0] = 0.0;
    bad[5].radius_mm[1] = 0.0;
    bad[6].n_points = 3;
    bad[7].n_points = ISO_TEMPLATE_POINTS_MAX + 1;
    bad[8].crop_radius_mm = 39.0;
    bad[9].crop_radius_mm = INFINITY;
    bad[10].spacing_mm = 0.4;
    bad[11].smoothing_mm = -1.0;
    bad[12].outlier_mm = 0.0;
    bad[13].fit.iterations = 0;
    bad[14].fit.identity_stiffness_mm2 = 0.0;
    bad[15].distance_min_mm = 0.0;
    bad[16].distance_max_mm = 299.0; /* below the least */
    bad[17].yaw_max_rad = -0.1;
    bad[18].yaw_max_rad = NAN;
    bad[19].pitch_max_rad = 1.6;
    bad[20].heat = (enum iso_heat_method)3;
    memset(bad[21].sensor, 'a', sizeof bad[21].sensor); /* does not end */
    bad[22].radius_mm[0] = 101.0;                       /* beyond the crop */
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        struct iso_extractor *none = NULL;
        assert_int_equal(iso_extractor_new(f->model, &bad[i], &none), -EINVAL);
        assert_null(none);
    }
    iso_extractor_free(NULL);
}

static void assert_refused(struct fixture *f)
{
    struct iso_extraction before;
    memset(&f->out, 0x5a, sizeof f->out);
    memcpy(&before, &f->out, sizeof before);
    assert_int_equal(iso_extractor_run(f->extractor, f->frame, &f->out), -EINVAL);
    assert_memory_equal(&f->out, &before, sizeof before);
}

static void bad_frames_are_refused(void **state)
{
    struct fixture *f = *state;
    const float depths[] = {NAN, INFINITY, -1.0f, 2e6f};
    for (int i = 0; i < 4; i++) {
        f->frame->depth_mm[100] = depths[i];
        assert_refused(f);
    }
    f->frame->depth_mm[100] = 0.0f;
    f->frame->crop_x_px = 1;
    assert_refused(f);
    f->frame->crop_x_px = 0;
    f->frame->camera.fx_px = 0.0;
    assert_refused(f);
    iso_frame_free(f->frame);
    const int sizes[][2] = {{1921, 1200}, {1920, 1201}};
    for (int i = 0; i < 2; i++) {
        struct iso_camera camera = rendered_head_camera();
        camera.width_px = sizes[i][0];
        camera.height_px = sizes[i][1];
        assert_int_equal(iso_frame_new(&camera, sizes[i][0], sizes[i][1], false, &f->frame), 0);
        assert_refused(f);
        iso_frame_free(f->frame);
    }
    f->frame = NULL;
}

/* Whatever camera iso_camera_check passes, up to the largest planes, down to one pixel. */
static void every_size_of_frame_can_be_run(void **state)
{
    struct fixture *f = *state;
    const struct {
        int width, height;
        double focal_px;
        bool holds_a_face;
    } cameras[] = {
        {1920, 1200, 1700.0, true}, /* a narrow view: shrunk by 11 */
        {1920, 1200, 300.0, true},  /* so wide that the coarse frame would be too large */
        {1920, 1200, 16.0, false},  {640, 400, 65536.0, false},
        {3, 2, 2000.0, false},      {1, 1, 500.0, false},
    };
    struct iso_rigid pose = rendered_head_pose(0, 0, iso_vec3(0, 0, 420));
    for (size_t i = 0; i < sizeof cameras / sizeof cameras[0]; i++) {
        struct iso_camera camera = {.projection = ISO_PINHOLE,
                                    .width_px = cameras[i].width,
                                    .height_px = cameras[i].height,
                                    .fx_px = cameras[i].focal_px,
                                    .fy_px = cameras[i].focal_px,
                                    .cx_px = cameras[i].width / 2.0,
                                    .cy_px = cameras[i].height / 2.0};
        iso_frame_free(f->frame);
        assert_int_equal(
            iso_frame_new(&camera, camera.width_px, camera.height_px, false, &f->frame), 0);
        rendered_head_draw(f->frame, f->model, NULL, 1.0, &pose);
        enum iso_capture outcome = run(f);
        assert_int_equal(outcome == ISO_CAPTURE_OK, cameras[i].holds_a_face);
    }
}

/* The widest patch at the distance at which its cut-out has the most pixels. */
static void the_widest_patch_has_room(void **state)
{
    struct fixture *f = *state;
    iso_extractor_free(f->extractor);
    f->extractor = NULL;
    f->options.crop_radius_mm = 150.0;
    assert_int_equal(iso_extractor_new(f->model, &f->options, &f->extractor), 0);
    struct iso_camera camera = {.projection = ISO_PINHOLE,
                                .width_px = 1000,
                                .height_px = 800,
                                .fx_px = 900.0,
                                .fy_px = 900.0,
                                .cx_px = 480.0,
                                .cy_px = 410.0};
    iso_frame_free(f->frame);
    assert_int_equal(iso_frame_new(&camera, 1000, 800, false, &f->frame), 0);
    for (double z_mm = 440.0; z_mm < 462.0; z_mm += 4.0) {
        assert_int_equal(outcome_of_mean(f, 0, 0, iso_vec3(0, 0, z_mm)), ISO_CAPTURE_OK);
    }
}

/* The outcome of every frame of a stored recording, in turn. */
static void run_stored(struct fixture *f, const char *name, size_t n_frames,
                       enum iso_capture *outcome)
{
    char path[256];
    struct iso_recording *recording = NULL;
    struct iso_frame *frame = NULL;
    (void)snprintf(path, sizeof path, "%s/sim/stored/%s", ISOTHERM_SOURCE_DIR, name);
    assert_int_equal(iso_recording_open(path, &recording, NULL), 0);
    assert_true(iso_recording_frames(recording) >= n_frames);
    assert_int_equal(iso_recording_frame_new(recording, &frame), 0);
    for (size_t i = 0; i < n_frames; i++) {
        assert_int_equal(iso_recording_read(recording, i, frame, NULL), 0);
        assert_int_equal(iso_extractor_run(f->extractor, frame, &f->out), 0);
        outcome[i] = f->out.outcome;
    }
    iso_frame_free(frame);
    iso_recording_close(recording);
}

static void stored_people_are_captured(void **state)
{
    struct fixture *f = *state;
    enum { PEOPLE = 24 };
    for (int person = 1; person <= PEOPLE; person++) {
        char name[16];
        enum iso_capture outcome;
        (void)snprintf(name, sizeof name, "p%02d-enrol", person);
        run_stored(f, name, 1, &outcome);
        assert_int_equal(outcome, ISO_CAPTURE_OK);
        assert_true(f->out.tmpl.quality > 0.8f);
        assert_true(f->out.distance_mm > 400.0 && f->out.distance_mm < 1000.0);
    }
}

/* Recordings without a usable face: the reason is one that fits. */
static void what_is_no_usable_face_says_why(void **state)
{
    struct fixture *f = *state;
    static const struct {
        const char *recording;
        unsigned reasons; /* bits */
    } rows[] = {
        {"none-nobody1", 1u << ISO_CAPTURE_NOBODY},
        /* a chair within reach: one frame does not tell it from a visitor */
        {"none-nobody2", 1u << ISO_CAPTURE_NOBODY | 1u << ISO_CAPTURE_NOT_A_FACE},
        {"none-back1", 1u << ISO_CAPTURE_NOT_A_FACE},
        {"none-back2", 1u << ISO_CAPTURE_NOT_A_FACE},
        {"none-back3", 1u << ISO_CAPTURE_NOT_A_FACE},
        {"none-cut4", 1u << ISO_CAPTURE_MOVE_LEFT | 1u << ISO_CAPTURE_MOVE_RIGHT},
        {"none-cut5", 1u << ISO_CAPTURE_MOVE_LEFT | 1u << ISO_CAPTURE_MOVE_RIGHT},
        {"none-photo1",
         1u << ISO_CAPTURE_NO_FACE | 1u << ISO_CAPTURE_NOT_A_FACE | 1u << ISO_CAPTURE_FLAT},
        {"none-photo2",
         1u << ISO_CAPTURE_NO_FACE | 1u << ISO_CAPTURE_NOT_A_FACE | 1u << ISO_CAPTURE_FLAT},
        {"none-photo3",
         1u << ISO_CAPTURE_NO_FACE | 1u << ISO_CAPTURE_NOT_A_FACE | 1u << ISO_CAPTURE_BENT},
    };
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        enum iso_capture outcome[3];
        run_stored(f, rows[i].recording, 3, outcome);
        for (int k = 0; k < 3; k++) {
            if (!(rows[i].reasons >> outcome[k] & 1u)) {
                fail_msg("%s, frame %d: %s", rows[i].recording, k, iso_capture_name(outcome[k]));
            }
        }
        assert_int_equal(f->out.tmpl.n_points, 0);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(the_mean_head_gives_its_pose_landmarks_and_template, set_up,
                                        tear_down),
        cmocka_unit_test_setup_teardown(hints_say_where_to_stand, set_up, tear_down),
        cmocka_unit_test_setup_teardown(hints_say_where_to_look, set_up, tear_down),
        cmocka_unit_test_setup_teardown(the_subjects_left_is_the_images_right, set_up, tear_down),
        cmocka_unit_test_setup_teardown(an_empty_scene_is_nobody, set_up, tear_down),
        cmocka_unit_test_setup_teardown(a_hidden_half_has_no_template, set_up, tear_down),
        cmocka_unit_test_setup_teardown(the_same_frame_gives_the_same_template, set_up, tear_down),
        cmocka_unit_test_setup_teardown(all_ways_to_the_heat_agree, set_up, tear_down),
        cmocka_unit_test_setup_teardown(heat_too_stiff_for_the_grid_is_released_on_the_mesh, set_up,
                                        tear_down),
        cmocka_unit_test_setup_teardown(the_mesh_and_its_heat_can_be_shown, set_up, tear_down),
        cmocka_unit_test_setup_teardown(stages_are_charged_by_the_clock_handed_in, set_up,
                                        tear_down),
        cmocka_unit_test_setup_teardown(bad_options_are_refused, set_up, tear_down),
        cmocka_unit_test_setup_teardown(bad_frames_are_refused, set_up, tear_down),
        cmocka_unit_test_setup_teardown(every_size_of_frame_can_be_run, set_up, tear_down),
        cmocka_unit_test_setup_teardown(the_widest_patch_has_room, set_up, tear_down),
        cmocka_unit_test_setup_teardown(stored_people_are_captured, set_up, tear_down),
        cmocka_unit_test_setup_teardown(what_is_no_usable_face_says_why, set_up, tear_down),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
