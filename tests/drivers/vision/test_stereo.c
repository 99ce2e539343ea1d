/* The stereo path on pictures with disparities in closed form: two ideal cameras see a random
 * pattern on planes. */
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

#include "drivers/stereo/stereo.h"

enum { WIDTH = 320, HEIGHT = 192, WAVES = 40 };

static const double focal_px = 400.0, baseline_mm = 60.0;

static struct iso_stereo_calibration rig(void)
{
    struct iso_camera camera = {.projection = ISO_PINHOLE,
                                .width_px = WIDTH,
                                .height_px = HEIGHT,
                                .fx_px = focal_px,
                                .fy_px = focal_px,
                                .cx_px = 0.5 * (WIDTH - 1),
                                .cy_px = 0.5 * (HEIGHT - 1)};
    return (struct iso_stereo_calibration){
        .camera = {camera, camera},
        .right_from_left = {iso_mat3_identity(), {-baseline_mm, 0.0, 0.0}}};
}

/* A sum of plane waves with lengths of about 8 px and more in the left picture. No two places are
 * alike. */
static double pattern(double x, double y)
{
    double sum = 0.0;
    for (int i = 1; i <= WAVES; i++) {
        double angle = 2.4 * i, rate = 0.2 + 0.6 * i / WAVES;
        sum += sin(rate * (x * cos(angle) + y * sin(angle)) + 1.7 * i * i);
    }
    return 128.0 + 60.0 * sum / sqrt(0.5 * WAVES) / 2.0;
}

struct scene {
    double at_px, slope; /* disparity = at + slope * (column - middle) of the left picture */
    int card_from, card_to;
    double card_px;      /* these columns have a card with this disparity; card_to 0: no card */
    bool even;           /* the surface has no pattern */
    double gain, offset; /* of the right camera */
};

static double plane_px(const struct scene *scene, double column)
{
    return scene->at_px + scene->slope * (column - 0.5 * WIDTH);
}

static uint8_t grey(const struct scene *scene, double x, double y)
{
    return (uint8_t)(scene->even ? 128.0 : fmin(fmax(nearbyint(pattern(x, y)), 0.0), 255.0));
}

static void draw(const struct scene *scene, uint8_t *left, uint8_t *right)
{
    for (int row = 0; row < HEIGHT; row++) {
        for (int column = 0; column < WIDTH; column++) {
            size_t i = (size_t)row * WIDTH + (size_t)column;
            bool card = column >= scene->card_from && column < scene->card_to;
            /* The card has its own pattern. */
            left[i] = grey(scene, column, card ? row + 5000.0 : row);
            /* x - d(x) = column, solved for the x of the left picture. */
            double x = (column + scene->at_px - 0.5 * WIDTH * scene->slope) / (1.0 - scene->slope);
            double on_card = column + scene->card_px;
            card = on_card >= scene->card_from && on_card < scene->card_to;
            double level = card ? grey(scene, on_card, row + 5000.0) : grey(scene, x, row);
            right[i] = (uint8_t)fmin(scene->gain * level + scene->offset, 255.0);
        }
    }
}

struct result {
    uint8_t left[WIDTH * HEIGHT], right[WIDTH * HEIGHT];
    struct iso_frame *frame;
    float confidence[WIDTH * HEIGHT];
};

static struct result *look_at(const struct scene *scene)
{
    struct iso_stereo_calibration calibration = rig();
    struct iso_stereo_options options = iso_stereo_options_default();
    struct iso_stereo *stereo = NULL;
    struct result *result = calloc(1, sizeof *result);
    const float *confidence = NULL;
    assert_non_null(result);
    options.near_mm = 400.0; /* 60 px */
    options.far_mm = 2000.0; /* 12 px */
    draw(scene, result->left, result->right);
    assert_int_equal(iso_stereo_new(&calibration, &options, &stereo, NULL), 0);
    assert_int_equal(iso_frame_new(&calibration.camera[0], WIDTH, HEIGHT, true, &result->frame), 0);
    assert_int_equal(
        iso_stereo_compute(stereo, result->left, result->right, &confidence, result->frame), 0);
    memcpy(result->confidence, confidence, sizeof result->confidence);
    struct iso_fault flaw = {.text = ""};
    assert_int_equal(iso_frame_check(result->frame, &flaw), 0);
    iso_stereo_free(stereo);
    return result;
}

static void done(struct result *result)
{
    iso_frame_free(result->frame);
    free(result);
}

/* Calculates the root mean square of the error of the disparity in the columns from..to, and the
 * share of pixels without a disparity. */
static void judge(const struct result *result, const struct scene *scene, int from, int to,
                  double *rms_px, double *holes)
{
    double squares = 0.0;
    int n = 0, empty = 0;
    for (int row = 12; row < HEIGHT - 12; row++) {
        for (int column = from; column < to; column++) {
            double z_mm = (double)iso_frame_depth_at(result->frame, column, row);
            bool card = column >= scene->card_from && column < scene->card_to;
            double truth = card ? scene->card_px : plane_px(scene, column);
            if (z_mm > 0.0) {
                double error = focal_px * baseline_mm / z_mm - truth;
                squares += error * error;
                n++;
            } else {
                empty++;
            }
        }
    }
    *rms_px = sqrt(squares / (n ? n : 1));
    *holes = (double)empty / (n + empty);
}

static void planes_come_out_to_a_fraction_of_a_pixel(void **state)
{
    (void)state;
    static const struct scene scenes[] = {
        {.at_px = 30.0, .gain = 1.0},
        {.at_px = 30.37, .gain = 1.0},
        {.at_px = 25.5, .slope = 0.06, .gain = 1.0},
        {.at_px = 40.8, .slope = -0.08, .gain = 1.0},
        {.at_px = 30.37, .gain = 0.8, .offset = 12.0}, /* the right picture is darker and hazier */
    };
    for (size_t i = 0; i < sizeof scenes / sizeof *scenes; i++) {
        struct result *result = look_at(&scenes[i]);
        double rms_px, holes;
        judge(result, &scenes[i], 80, WIDTH - 12, &rms_px, &holes);
        print_message("disparity %.2f slope %+.2f gain %.1f: rms %.3f px, holes %.2f %%\n",
                      scenes[i].at_px, scenes[i].slope, scenes[i].gain, rms_px, 100.0 * holes);
        assert_true(rms_px < 0.05);
        assert_true(holes < 0.01);
        done(result);
    }
}

/* On the left of a card there are 20 px that the right camera does not see. */
static void points_that_only_one_camera_sees_are_not_measured(void **state)
{
    (void)state;
    static const struct scene scene = {
        .at_px = 20.0, .card_from = 150, .card_to = 250, .card_px = 40.0, .gain = 1.0};
    struct result *result = look_at(&scene);
    double rms_px, holes;
    judge(result, &scene, 158, 242, &rms_px, &holes);
    print_message("on the card: rms %.3f px, holes %.2f %%\n", rms_px, 100.0 * holes);
    assert_true(rms_px < 0.05 && holes < 0.01);
    judge(result, &scene, 262, WIDTH - 12, &rms_px, &holes);
    print_message("at its right: rms %.3f px, holes %.2f %%\n", rms_px, 100.0 * holes);
    assert_true(rms_px < 0.05 && holes < 0.01);
    judge(result, &scene, 134, 146, &rms_px, &holes);
    print_message("hidden from the right camera: %.2f %% without a depth\n", 100.0 * holes);
    assert_true(holes > 0.9);
    done(result);
}

static void even_pictures_have_no_depth(void **state)
{
    (void)state;
    static const struct scene scene = {.at_px = 30.0, .even = true, .gain = 1.0};
    struct result *result = look_at(&scene);
    for (size_t i = 0; i < (size_t)WIDTH * HEIGHT; i++) {
        assert_true(!(result->frame->depth_mm[i] > 0.0f) && !(result->confidence[i] > 0.0f));
    }
    done(result);
}

static void different_pictures_do_not_match(void **state)
{
    (void)state;
    /* The pattern is shifted by 2000 px in the right picture. */
    static const struct scene scene = {.at_px = 2000.0, .gain = 1.0};
    struct result *result = look_at(&scene);
    double rms_px, holes;
    judge(result, &scene, 80, WIDTH - 12, &rms_px, &holes);
    print_message("%.2f %% of false matches\n", 100.0 * (1.0 - holes));
    assert_true(holes > 0.9);
    done(result);
}

static void intensity_is_the_rectified_left_picture(void **state)
{
    (void)state;
    static const struct scene scene = {.at_px = 30.0, .gain = 1.0};
    struct result *result = look_at(&scene);
    for (size_t i = 0; i < (size_t)WIDTH * HEIGHT; i++) {
        assert_true(fabsf(result->frame->intensity[i] * 255.0f - (float)result->left[i]) < 0.51f);
        assert_true(result->confidence[i] >= 0.0f && result->confidence[i] <= 1.0001f);
        assert_true(!(result->frame->depth_mm[i] > 0.0f) || result->confidence[i] >= 0.75f);
    }
    assert_true(result->frame->camera.fx_px == focal_px);
    done(result);
}

static void refuses_what_cannot_work(void **state)
{
    (void)state;
    struct iso_stereo_calibration calibration = rig();
    struct iso_stereo *stereo = NULL;
    struct iso_fault fault = {.text = ""};
    struct iso_stereo_options good = iso_stereo_options_default(), bad[5];
    for (int i = 0; i < 5; i++) {
        bad[i] = good;
    }
    bad[0].near_mm = 50.0;
    bad[1].far_mm = 200.0;
    bad[2].confidence_min = NAN;
    bad[3].window_px = 8;
    bad[4].window_px = 33;
    for (int i = 0; i < 5; i++) {
        assert_int_equal(iso_stereo_new(&calibration, &bad[i], &stereo, &fault), -EINVAL);
        assert_int_equal(strncmp(fault.text, "stereo: ", 8), 0);
    }
    calibration.right_from_left.translation_mm.x = 60.0;
    assert_int_equal(iso_stereo_new(&calibration, &good, &stereo, &fault), -EINVAL);
    assert_string_equal(fault.text, "stereo: the right camera stands at the left");
    calibration = rig();
    calibration.camera[0].width_px = calibration.camera[1].width_px = WIDTH + 1;
    assert_int_equal(iso_stereo_new(&calibration, &good, &stereo, &fault), -EINVAL);
    assert_null(stereo);
    iso_stereo_free(NULL);
}

static void refuses_a_frame_of_another_size(void **state)
{
    (void)state;
    struct iso_stereo_calibration calibration = rig();
    struct iso_stereo_options options = iso_stereo_options_default();
    struct iso_stereo *stereo = NULL;
    struct iso_frame *frame = NULL;
    uint8_t *picture = calloc(WIDTH, HEIGHT);
    assert_int_equal(iso_stereo_new(&calibration, &options, &stereo, NULL), 0);
    assert_int_equal(iso_frame_new(&calibration.camera[0], HEIGHT, WIDTH, false, &frame), 0);
    assert_int_equal(iso_stereo_compute(stereo, picture, picture, NULL, frame), -EINVAL);
    free(picture);
    iso_frame_free(frame);
    iso_stereo_free(stereo);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(planes_come_out_to_a_fraction_of_a_pixel),
        cmocka_unit_test(points_that_only_one_camera_sees_are_not_measured),
        cmocka_unit_test(even_pictures_have_no_depth),
        cmocka_unit_test(different_pictures_do_not_match),
        cmocka_unit_test(intensity_is_the_rectified_left_picture),
        cmocka_unit_test(refuses_what_cannot_work),
        cmocka_unit_test(refuses_a_frame_of_another_size),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
