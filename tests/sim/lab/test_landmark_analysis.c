/* The figures of the benchmark on artificial frames. Every rate is calculated by hand. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "sim/lab/landmarks/analysis.h"
#include "sim/lab/landmarks/true_angle.h"
#include "tests/support/near.h"

enum { FRAMES = 15 };

static struct sim_corpus_row rows[] = {
    {.recording = "a1", .count = 2, .subject = "ann", .session = "s1", .expression = "smile"},
    {.recording = "a2", .count = 1, .subject = "ann", .session = "s2"},
    {.recording = "b", .count = 2, .subject = "bob", .session = "s1", .expression = "frown"},
    {.recording = "p1", .count = 2, .subject = "none", .note = "photo-flat"},
    {.recording = "p2", .count = 1, .subject = "none", .note = "photo-flat"},
    {.recording = "p3", .count = 1, .subject = "none", .note = "photo-flat"},
    {.recording = "c", .count = 2, .subject = "none", .note = "chair"},
    {.recording = "d", .count = 1, .subject = "cat", .session = "s1"},
    {.recording = "m", .count = 3, .subject = "none", .note = "mask-still"},
};
static const struct sim_corpus corpus = {sizeof rows / sizeof *rows, rows};

/* The outcome of each frame, in the order of the rows. Ann's and Bob's frames have errors. */
static const struct {
    int reason;
    double degrees;
    struct iso_vec3 nose_mm, nasion_mm;
} made_up[FRAMES] = {
    {ISO_CAPTURE_OK, 10.0, {4, 0, 0}, {0, 2, 0}},
    {ISO_CAPTURE_OK, 30.0, {0, 0, 11}, {0, 0, 11}},
    {ISO_CAPTURE_OK, 30.0, {11, 0, 0}, {0, 9.5, 0}},
    {ISO_CAPTURE_NOT_A_FACE, 40.0, {0, -20, 0}, {0, -20, 0}},
    {ISO_CAPTURE_TOO_FEW_POINTS, 20.0, {1, 0, 0}, {0, 0, 0}},
    {.reason = ISO_CAPTURE_NOT_A_FACE}, /* photo: refused, then an attack */
    {.reason = ISO_CAPTURE_FLAT},
    {.reason = ISO_CAPTURE_OK},
    {.reason = SIM_REASON_UNREADABLE},
    {.reason = ISO_CAPTURE_NO_FACE}, /* chair */
    {.reason = ISO_CAPTURE_OK},
    {.reason = ISO_CAPTURE_FLAT}, /* cat */
    {.reason = ISO_CAPTURE_FLAT}, /* mask: accepted at the second frame */
    {.reason = ISO_CAPTURE_OK},
    {.reason = ISO_CAPTURE_FLAT},
};

static struct sim_measured_frame frames[FRAMES];
static struct sim_measurement measurement = {
    .n_frames = FRAMES, .frames = frames, .offset_mm = {[ISO_LM_NOSE_TIP] = {1, 0, 0}}};

static void make_frames(void)
{
    size_t i = 0;
    for (size_t r = 0; r < corpus.n_rows; r++) {
        for (size_t k = 0; k < rows[r].count; k++, i++) {
            struct sim_measured_frame *f = &frames[i];
            *f = (struct sim_measured_frame){
                .row = r,
                .frame = k,
                .reason = made_up[i].reason,
                .fitted = r < 3,
                .true_angle_rad = r < 3 ? made_up[i].degrees * M_PI / 180.0 : NAN,
                .cpu_ns = 1000000 * (int64_t)(i + 1),
            };
            f->stage_ns[ISO_STAGE_HEAT] = i < 3 ? 2000000 * (int64_t)(i + 1) : 0;
            if (f->fitted) {
                f->n_known = 2;
                f->deviation.row = r;
                f->deviation.known[ISO_LM_NOSE_TIP] = f->deviation.known[ISO_LM_NASION] = true;
                f->deviation.error_mm[ISO_LM_NOSE_TIP] = made_up[i].nose_mm;
                f->deviation.error_mm[ISO_LM_NASION] = made_up[i].nasion_mm;
                sim_measure_frame_errors(measurement.offset_mm, f);
            }
        }
    }
}

static struct sim_landmark_analysis *analysis_of_all(void)
{
    struct sim_landmark_analysis *a = NULL;
    make_frames();
    assert_int_equal(sim_landmark_analyse(&corpus, &measurement, &a), 0);
    return a;
}

static void expect_rate(struct sim_rate rate, size_t events, size_t trials)
{
    assert_int_equal(rate.events, events);
    assert_int_equal(rate.trials, trials);
}

static void test_frame_errors(void **state)
{
    (void)state;
    make_frames();
    assert_near(frames[0].error_mean_mm, 3.0, 1e-12);
    assert_near(frames[0].error_max_mm, 4.0, 1e-12);
    assert_near(frames[0].centred_mean_mm, 2.5, 1e-12);
    assert_near(frames[0].centred_max_mm, 3.0, 1e-12);
    assert_near(frames[2].error_mean_mm, 10.25, 1e-12);
    assert_near(frames[2].centred_mean_mm, 9.75, 1e-12);
    assert_near(frames[2].centred_max_mm, 10.0, 1e-12);
    assert_true(sim_frame_fails(&frames[2], SIM_FAILURE_MEAN));
    assert_false(sim_frame_fails(&frames[2], SIM_FAILURE_CENTRED_MEAN));
    assert_false(sim_frame_fails(&frames[2], SIM_FAILURE_CENTRED_MAX)); /* 10 mm, not more */
    assert_true(sim_frame_fails(&frames[1], SIM_FAILURE_CENTRED_MAX));
}

/* The offset is computed from frames of people only, refused ones included. */
static void test_offsets(void **state)
{
    (void)state;
    make_frames();
    frames[13].n_known = 1; /* of a mask */
    frames[13].deviation = frames[1].deviation;
    frames[13].deviation.row = 8;
    struct iso_vec3 offset_mm[ISO_LANDMARKS];
    for (int repeat = 0; repeat < 2; repeat++) {
        assert_int_equal(sim_measure_offsets(&corpus, frames, FRAMES, offset_mm), 0);
        /* Of x = 4, 0, 11, 0, 1; of y = 0, 0, 0, -20, 0; of z = 0, 11, 0, 0, 0. */
        assert_near(offset_mm[ISO_LM_NOSE_TIP].x, 1.0, 0.0);
        assert_near(offset_mm[ISO_LM_NOSE_TIP].y, 0.0, 0.0);
        assert_near(offset_mm[ISO_LM_NOSE_TIP].z, 0.0, 0.0);
        frames[13].deviation.error_mm[ISO_LM_NOSE_TIP] = iso_vec3(500, 500, 500);
        frames[14] = frames[12] = frames[13];
    }
}

static void test_failures(void **state)
{
    (void)state;
    struct sim_landmark_analysis *a = analysis_of_all();
    assert_int_equal(a->n_bona_fide, 6);
    assert_int_equal(a->n_true, 5);
    expect_rate(a->all.refused, 3, 6);
    const struct sim_failures *mean = &a->all.failures[SIM_FAILURE_MEAN];
    expect_rate(mean->before, 3, 5);
    expect_rate(mean->after, 2, 3);
    expect_rate(mean->good_refused, 1, 2);
    const struct sim_failures *centred = &a->all.failures[SIM_FAILURE_CENTRED_MEAN];
    expect_rate(centred->before, 2, 5);
    expect_rate(centred->after, 1, 3);
    expect_rate(centred->good_refused, 1, 3);
    assert_int_equal(a->reason[ISO_CAPTURE_OK], 3);
    assert_int_equal(a->reason[ISO_CAPTURE_NOT_A_FACE], 1);
    assert_int_equal(a->reason[ISO_CAPTURE_TOO_FEW_POINTS], 1);
    assert_int_equal(a->reason[ISO_CAPTURE_FLAT], 1);
    sim_landmark_analysis_free(a);
}

static void test_landmarks_before_and_after_the_gates(void **state)
{
    (void)state;
    struct sim_landmark_analysis *a = analysis_of_all();
    const struct sim_landmark_error *nose = &a->after[ISO_LM_NOSE_TIP];
    assert_int_equal(nose->error_mm.n, 3);
    assert_near(nose->error_mm.mean, (4.0 + 11.0 + 11.0) / 3.0, 1e-12);
    assert_near(nose->centred_error_mm.median, 10.0, 1e-12);
    assert_near(nose->offset_mm.x, 1.0, 0.0);
    /* Ann's sessions: means (2, 0, 5.5) and (11, 0, 0). */
    struct iso_vec3 mean = iso_vec3(6.5, 0, 2.75);
    assert_int_equal(nose->repeat_mm.n, 3);
    assert_near(nose->repeat_mm.max, iso_norm(iso_sub(iso_vec3(0, 0, 11), mean)), 1e-12);
    assert_int_equal(nose->slip_mm.n, 2);
    assert_int_equal(a->before[ISO_LM_NOSE_TIP].error_mm.n, 5);
    assert_near(a->before[ISO_LM_NOSE_TIP].error_mm.max, 20.0, 1e-12);
    assert_int_equal(a->before[ISO_LANDMARKS].error_mm.n, 10);
    assert_int_equal(a->after[ISO_LM_MOUTH_R].error_mm.n, 0);
    sim_landmark_analysis_free(a);
}

static const struct sim_condition_figures *condition(const struct sim_landmark_analysis *a,
                                                     const char *value)
{
    for (size_t i = 0; i < a->n_conditions; i++) {
        if (strcmp(a->conditions[i].value, value) == 0) {
            return &a->conditions[i];
        }
    }
    fail_msg("no condition '%s'", value);
    return NULL;
}

static void test_conditions(void **state)
{
    (void)state;
    struct sim_landmark_analysis *a = analysis_of_all();
    assert_int_equal(a->n_conditions, 5);
    const struct sim_condition_figures *near = condition(a, "<= 25"), *far = condition(a, "25..35");
    expect_rate(near->refused, 1, 2);
    expect_rate(near->failures[SIM_FAILURE_MEAN].before, 0, 2);
    expect_rate(near->failures[SIM_FAILURE_MEAN].after, 0, 1);
    assert_int_equal(near->error_mm.n, 2);
    assert_near(near->error_mm.mean, 3.0, 1e-12);
    assert_near(near->centred_error_mm.mean, 2.5, 1e-12);
    expect_rate(far->refused, 0, 2);
    expect_rate(far->failures[SIM_FAILURE_MEAN].before, 2, 2);
    expect_rate(far->failures[SIM_FAILURE_CENTRED_MEAN].after, 1, 2);
    expect_rate(condition(a, "> 35")->refused, 1, 1);
    expect_rate(condition(a, "smile")->refused, 0, 2);
    expect_rate(condition(a, "frown")->refused, 2, 2);
    assert_int_equal(condition(a, "frown")->error_mm.n, 0);
    assert_int_equal(a->all.error_mm.n, 6);
    assert_near(a->all.error_mm.mean, 48.5 / 6.0, 1e-12);
    assert_near(a->all.error_mm.median, 9.5, 1e-12);
    sim_landmark_analysis_free(a);
}

static void test_attacks_and_not_faces(void **state)
{
    (void)state;
    struct sim_landmark_analysis *a = analysis_of_all();
    assert_int_equal(a->n_kinds, 3);
    const struct sim_kind_figures *photo = &a->kinds[0], *chair = &a->kinds[1],
                                  *mask = &a->kinds[2];
    assert_string_equal(photo->note, "photo-flat");
    assert_int_equal(photo->kind, SIM_ROW_ATTACK);
    expect_rate(photo->response[SIM_RESPONSE_BONA_FIDE], 1, 3); /* APCER */
    expect_rate(photo->response[SIM_RESPONSE_NONE], 1, 3);      /* APNRR */
    expect_rate(photo->response[SIM_RESPONSE_ATTACK], 1, 3);
    expect_rate(photo->accepted_frames, 1, 4);
    assert_int_equal(photo->reason[SIM_REASON_UNREADABLE], 1);
    assert_int_equal(chair->kind, SIM_ROW_NOT_A_FACE);
    expect_rate(chair->accepted_frames, 1, 2);
    assert_int_equal(mask->kind, SIM_ROW_ATTACK);
    expect_rate(mask->response[SIM_RESPONSE_BONA_FIDE], 1, 1);
    expect_rate(mask->accepted_frames, 1, 3);
    /* Rows of people: ann, ann, bob, cat. */
    expect_rate(a->bona_fide[SIM_RESPONSE_BONA_FIDE], 2, 4);
    expect_rate(a->bona_fide[SIM_RESPONSE_ATTACK], 1, 4); /* BPCER */
    expect_rate(a->bona_fide[SIM_RESPONSE_NONE], 1, 4);   /* BPNRR */
    sim_landmark_analysis_free(a);
}

static void test_times(void **state)
{
    (void)state;
    struct sim_landmark_analysis *a = analysis_of_all();
    assert_int_equal(a->stage[ISO_STAGE_HEAT].n, 3);
    assert_near(a->stage[ISO_STAGE_HEAT].median_ms, 4.0, 1e-12);
    assert_int_equal(a->stage[ISO_STAGE_MESH].n, 0);
    assert_int_equal(a->whole.n, FRAMES);
    assert_near(a->whole.median_ms, 8.0, 1e-12);
    sim_landmark_analysis_free(a);
}

static enum sim_row_kind kind_of(const char *subject, const char *note)
{
    struct sim_corpus_row row = {.count = 1};
    strcpy(row.subject, subject);
    strcpy(row.note, note);
    return sim_row_kind_of(&row);
}

static void test_row_kinds(void **state)
{
    (void)state;
    static const char *const attacks[] = {"photo",      "photo-bent", "screen",
                                          "mask-small", "mask-large", "print-eyes-cut",
                                          "mask-still", "frozen"};
    for (size_t i = 0; i < sizeof attacks / sizeof *attacks; i++) {
        assert_int_equal(kind_of("none", attacks[i]), SIM_ROW_ATTACK);
        assert_int_equal(kind_of("p01", attacks[i]), SIM_ROW_BONA_FIDE);
    }
    assert_int_equal(kind_of("none", ""), SIM_ROW_NOT_A_FACE);
    assert_int_equal(kind_of("none", "back"), SIM_ROW_NOT_A_FACE);
    assert_int_equal(kind_of("none", "printer"), SIM_ROW_NOT_A_FACE);
    assert_int_equal(kind_of("p01", "bona-fide"), SIM_ROW_BONA_FIDE);
}

/* Makes a head model whose only vertices are the landmarks. */
static struct iso_head_model *new_points(const struct iso_vec3 mean_mm[ISO_LANDMARKS])
{
    struct iso_head_model *model = NULL;
    assert_int_equal(iso_head_model_new(ISO_LANDMARKS, ISO_LANDMARKS, 1, 1, &model), 0);
    for (uint32_t l = 0; l < ISO_LANDMARKS; l++) {
        model->mean_mm[l] = mean_mm[l];
        model->triangles[l][0] = l;
        model->landmarks[iso_landmark_ibug[l]] = (struct iso_head_point){l, {1.0f, 0.0f, 0.0f}};
    }
    return model;
}

static void test_true_angle(void **state)
{
    (void)state;
    struct iso_vec3 mean_mm[ISO_LANDMARKS];
    for (int l = 0; l < ISO_LANDMARKS; l++) {
        mean_mm[l] = iso_vec3(20.0 * (l % 3 - 1), 15.0 * (l / 3), -4.0 * (l % 4));
    }
    struct iso_head_model *model = new_points(mean_mm);
    const struct iso_mat3 facing = {{{1, 0, 0}, {0, -1, 0}, {0, 0, -1}}};
    struct iso_mat3 yaw = iso_mat3_rotation(iso_vec3(0, 0.5, 0));
    struct iso_mat3 pitch = iso_mat3_rotation(iso_vec3(-0.3, 0, 0));
    struct iso_mat3 turned = iso_mat3_mul(&yaw, &pitch);
    struct iso_rigid camera_from_face = {iso_mat3_mul(&facing, &turned), {30, -40, 700}};
    struct sim_truth truth = {{false}, {{0, 0, 0}}};
    for (int l = 0; l < ISO_LANDMARKS; l++) {
        truth.known[l] = true;
        truth.point_mm[l] = iso_rigid_apply(&camera_from_face, mean_mm[l]);
    }
    /* The position of the mouth does not show the pose. */
    truth.point_mm[ISO_LM_MOUTH_L] = iso_vec3(500, 500, 500);
    assert_near(sim_true_angle(model, &truth, ""), acos(cos(0.5) * cos(0.3)), 1e-9);
    /* Landmarks take precedence over the pose in the manifest. If both are missing, there is no
     * angle. */
    assert_near(sim_true_angle(model, &truth, "y+60p+00r+00"), acos(cos(0.5) * cos(0.3)), 1e-9);
    memset(truth.known, 0, sizeof truth.known);
    truth.known[ISO_LM_NASION] = truth.known[ISO_LM_MOUTH_R] = truth.known[ISO_LM_MOUTH_L] =
        truth.known[ISO_LM_LIP_UPPER] = true;
    assert_near(sim_true_angle(model, &truth, "y-30p+40r+07"),
                acos(cos(30.0 * M_PI / 180.0) * cos(40.0 * M_PI / 180.0)), 1e-12);
    assert_near(sim_true_angle(model, &truth, "y+110p+00r-09"), 110.0 * M_PI / 180.0, 1e-12);
    assert_true(isnan(sim_true_angle(model, &truth, "frontal")));
    assert_true(isnan(sim_true_angle(model, &truth, "y+10p+10r+10x")));
    assert_true(isnan(sim_true_angle(model, &truth, "")));
    iso_head_model_free(model);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_frame_errors),
        cmocka_unit_test(test_offsets),
        cmocka_unit_test(test_failures),
        cmocka_unit_test(test_landmarks_before_and_after_the_gates),
        cmocka_unit_test(test_conditions),
        cmocka_unit_test(test_attacks_and_not_faces),
        cmocka_unit_test(test_times),
        cmocka_unit_test(test_row_kinds),
        cmocka_unit_test(test_true_angle),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
