/* Cues of a presentation attack: sheets compared with closed forms, then scenes by the extractor.
 */
#include <errno.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

#include "core/presentation/presentation.h"
#include "isotherm/extract.h"
#include "tests/core/surfaces/presented.h"
#include "tests/core/surfaces/rendered_head.h"
#include "tests/core/surfaces/shipped_model.h"

enum { SIDE = 20, GRID = SIDE * SIDE };

/* Writes a grid of 6 mm with the heights z(x, y), turned about the z axis. Returns the number of
 * points. */
static int grid_of(double (*z)(double x, double y), double turn_rad, struct iso_vec3 points[GRID])
{
    for (int i = 0; i < GRID; i++) {
        double x = 6.0 * (i % SIDE - 9.5), y = 6.0 * (i / SIDE - 9.5);
        points[i] = iso_vec3(x * cos(turn_rad) - y * sin(turn_rad),
                             x * sin(turn_rad) + y * cos(turn_rad), z(x, y));
    }
    return GRID;
}

static double tilted(double x, double y)
{
    return 7.0 + 0.3 * x - 0.2 * y;
}

static double roll(double x, double y)
{
    return 0.2 * y - (80.0 - sqrt(80.0 * 80.0 - x * x));
}

static double s_bend(double x, double y)
{
    return -0.1 * y + 9.0 * sin(x / 18.0);
}

static double ball(double x, double y)
{
    return sqrt(90.0 * 90.0 - x * x - y * y);
}

static void a_plane_fits_a_plane(void **state)
{
    (void)state;
    struct iso_vec3 points[GRID];
    struct iso_sheet_fit fit;
    double plane[3];
    int n = grid_of(tilted, 0.0, points);
    for (int i = 0; i < n / 10; i++) {
        points[7 * i % n].z += 30.0; /* a finger in front of it */
    }
    assert_int_equal(iso_plane_fit(points, n, 4.0, plane, &fit), 0);
    assert_true(fabs(plane[0] - 7.0) < 1e-6 && fabs(plane[1] - 0.3) < 1e-6 &&
                fabs(plane[2] + 0.2) < 1e-6);
    assert_true(fabs(fit.inlier_share - 0.9) < 1e-9);
    assert_int_equal(iso_plane_fit(points, 23, 4.0, plane, &fit), -ENODATA);
    assert_int_equal(iso_bent_sheet_fit(points, 23, 4.0, &fit), -ENODATA);
    for (int i = 0; i < n; i++) {
        points[i] = iso_vec3(0, 0, 0);
    }
    assert_int_equal(iso_plane_fit(points, n, 4.0, plane, &fit), -ENODATA);
}

static void a_bent_sheet_fits_surfaces_that_bend_about_one_axis(void **state)
{
    (void)state;
    struct iso_vec3 points[GRID];
    struct iso_sheet_fit fit;
    double plane[3];
    for (double turn = 0.0; turn < 3.1; turn += 0.37) {
        assert_int_equal(iso_bent_sheet_fit(points, grid_of(roll, turn, points), 4.0, &fit), 0);
        assert_true(fit.inlier_share > 0.999 && fit.rms_mm < 0.6);
        double off = fabs(remainder(fit.angle_rad - turn, M_PI));
        assert_true(off < 0.05);
        /* Sagitta of a 114 mm chord of a circle of 80 mm, over the slope of a leaning plane. */
        assert_true(fabs(fit.bend_mm - (80.0 - sqrt(80.0 * 80.0 - 57.0 * 57.0))) < 1.5);
        assert_int_equal(iso_plane_fit(points, GRID, 4.0, plane, &fit), 0);
        assert_true(fit.inlier_share < 0.6);
        assert_int_equal(iso_bent_sheet_fit(points, grid_of(s_bend, turn, points), 4.0, &fit), 0);
        assert_true(fit.inlier_share > 0.99);
    }
    assert_int_equal(iso_bent_sheet_fit(points, grid_of(ball, 0.3, points), 4.0, &fit), 0);
    assert_true(fit.inlier_share < 0.6);
}

static struct iso_presentation_cues face_like(void)
{
    struct iso_presentation_cues cues = {.has_relief = true, .has_size = true, .has_eyes = true};
    cues.relief.flat.inlier_share = 0.3;
    cues.relief.bent.inlier_share = 0.7;
    cues.size.scale = cues.fitted_scale = 1.0;
    cues.identity_norm = 0.4;
    cues.eyes[ISO_EYE_R].around_share = cues.eyes[ISO_EYE_L].around_share = 0.9;
    cues.eyes[ISO_EYE_R].depth_mm = cues.eyes[ISO_EYE_L].depth_mm = -3.0;
    return cues;
}

static void every_cue_has_its_word(void **state)
{
    (void)state;
    const struct iso_presentation_options o = iso_presentation_options_default();
    struct iso_presentation_cues cues = {0};
    assert_int_equal(iso_presentation_judge(&cues, &o), ISO_CAPTURE_OK);
    cues = face_like();
    assert_int_equal(iso_presentation_judge(&cues, &o), ISO_CAPTURE_OK);
    cues.eyes[ISO_EYE_R].depth_mm = 9.0; /* one eye hole is no mask */
    assert_int_equal(iso_presentation_judge(&cues, &o), ISO_CAPTURE_OK);
    cues.eyes[ISO_EYE_L].hole_share = 1.0;
    cues.eyes[ISO_EYE_L].depth_mm = 0.0;
    assert_int_equal(iso_presentation_judge(&cues, &o), ISO_CAPTURE_EYES_CUT);
    struct iso_presentation_options loses = o;
    loses.eye_hole_share = 1.1;
    assert_int_equal(iso_presentation_judge(&cues, &loses), ISO_CAPTURE_OK);
    cues.size.scale = cues.fitted_scale = 1.3;
    assert_int_equal(iso_presentation_judge(&cues, &o), ISO_CAPTURE_WRONG_SIZE);
    cues.size.scale = cues.fitted_scale = 0.75;
    assert_int_equal(iso_presentation_judge(&cues, &o), ISO_CAPTURE_WRONG_SIZE);
    cues.size.scale = cues.fitted_scale = 1.0;
    cues.size.cost_mm2 = 8.0; /* it fits at no size */
    assert_int_equal(iso_presentation_judge(&cues, &o), ISO_CAPTURE_WRONG_SIZE);
    cues.relief.bent.inlier_share = 0.95;
    assert_int_equal(iso_presentation_judge(&cues, &o), ISO_CAPTURE_BENT);
    cues.relief.bent.inlier_share = 0.78; /* like an unusual head */
    cues.identity_norm = 1.0;
    assert_int_equal(iso_presentation_judge(&cues, &o), ISO_CAPTURE_BENT);
    cues.identity_norm = 0.4;
    assert_int_equal(iso_presentation_judge(&cues, &o), ISO_CAPTURE_WRONG_SIZE);
    cues.relief.flat.inlier_share = 0.9;
    assert_int_equal(iso_presentation_judge(&cues, &o), ISO_CAPTURE_FLAT);
    cues = (struct iso_presentation_cues){.has_sheet = true};
    cues.sheet.area_mm2 = 50000.0;
    assert_int_equal(iso_presentation_judge(&cues, &o), ISO_CAPTURE_OK);
    cues.sheet.bent.inlier_share = 0.95;
    assert_int_equal(iso_presentation_judge(&cues, &o), ISO_CAPTURE_BENT);
    cues.sheet.flat.inlier_share = 0.95;
    assert_int_equal(iso_presentation_judge(&cues, &o), ISO_CAPTURE_FLAT);
    cues.sheet.hole_share = 0.4;
    assert_int_equal(iso_presentation_judge(&cues, &o), ISO_CAPTURE_SCREEN);
    cues.sheet.area_mm2 = 500000.0; /* a wall */
    assert_int_equal(iso_presentation_judge(&cues, &o), ISO_CAPTURE_OK);
}

enum kind { PERSON, FLAT, ROLLED, WAVY, CREASED, DISPLAY, SMALL, LARGE, EYES_CUT, KINDS };

/* Draws and measures one presentation. */
static void present(struct presented *p, enum kind kind)
{
    presented_clear(p);
    struct iso_rigid pose = presented_draw_pose(p);
    presented_draw_person(p);
    struct presented_sheet sheet = presented_draw_sheet(
        p, kind == DISPLAY ? PRESENTED_FLAT : (enum presented_bend)(kind - FLAT) % 4);
    sheet.oval = sheet.oval && kind != DISPLAY;
    if (kind == PERSON) {
        presented_head(p, &pose, 1.0, 0);
    } else if (kind <= DISPLAY) {
        presented_sheet(p, &sheet, &pose);
    } else if (kind == EYES_CUT) {
        presented_head(p, &pose, 1.0, PRESENTED_EYES_CUT);
        presented_behind(p, &pose, 20.0);
    } else {
        presented_head(p, &pose,
                       kind == SMALL ? sim_random_between(&p->random, 0.45, 0.74)
                                     : sim_random_between(&p->random, 1.33, 1.6),
                       0);
    }
    presented_measure(p);
    if (kind == DISPLAY) {
        presented_blind(p, &sheet, &pose, 10.0, 0.6);
    }
}

/* Counts how many presentations of a kind have each outcome. */
static void count(struct iso_extractor *x, struct presented *p, enum kind kind, int n,
                  int outcomes[ISO_CAPTURES])
{
    for (int i = 0; i < n; i++) {
        struct iso_extraction out;
        present(p, kind);
        assert_int_equal(iso_extractor_locate(x, p->frame, &out), 0);
        outcomes[out.outcome]++;
    }
}

static void pictures_and_masks_are_refused_and_people_are_not(void **state)
{
    (void)state;
    enum { EACH = 8 };
    static const char *const names[KINDS] = {"person",  "flat",  "rolled", "wavy",    "creased",
                                             "display", "small", "large",  "eyes-cut"};
    struct iso_head_model *model = shipped_head_model();
    const struct iso_extract_options options = iso_extract_options_default();
    const struct sim_sensor *const sensors[] = {&sim_sensor_astra, &sim_sensor_kinect2};
    for (int s = 0; s < 2; s++) {
        struct iso_extractor *x = NULL;
        assert_int_equal(iso_extractor_new(model, &options, &x), 0);
        struct presented *p = presented_new(sensors[s], model, 5);
        for (int kind = 0; kind < KINDS; kind++) {
            int outcomes[ISO_CAPTURES] = {0}, attacks = 0;
            count(x, p, (enum kind)kind, EACH, outcomes);
            for (int c = 0; c < ISO_CAPTURES; c++) {
                attacks += iso_capture_is_attack((enum iso_capture)c) ? outcomes[c] : 0;
            }
            print_message("%s %s: %d accepted, %d called an attack, of %d\n", sensors[s]->name,
                          names[kind], outcomes[ISO_CAPTURE_OK], attacks, EACH);
            /* One in a hundred people has an extraordinary head. One refusal is allowed, and no
             * more. */
            if (kind == PERSON) {
                assert_int_equal(outcomes[ISO_CAPTURE_OK] + outcomes[ISO_CAPTURE_WRONG_SIZE], EACH);
                assert_true(outcomes[ISO_CAPTURE_WRONG_SIZE] <= 1);
                continue;
            }
            /* The sensor does not see openings that are narrower than its windows. */
            assert_true(outcomes[ISO_CAPTURE_OK] <= (kind == EYES_CUT ? EACH / 2 : 0));
            /* Most masks that are too small, and many that are too large, are not taken for a face
             * at all. */
            assert_true(kind == SMALL || attacks >= (kind == LARGE ? 1 : EACH / 2));
        }
        presented_free(p);
        iso_extractor_free(x);
    }
    iso_head_model_free(model);
}

/* The scale of a rendered head is found, from a pose that is not quite right. */
static void the_size_of_the_mean_face_is_found(void **state)
{
    (void)state;
    struct iso_head_model *model = shipped_head_model();
    struct iso_frame *frame = rendered_head_frame();
    struct iso_sizer *sizer = NULL;
    assert_int_equal(iso_sizer_new(model, &sizer), 0);
    const double sizes[] = {0.7, 0.85, 1.0, 1.2, 1.45};
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
        struct iso_rigid pose = rendered_head_pose(12.0, -6.0, iso_vec3(20, -10, 560));
        struct iso_rigid start = rendered_head_pose(10.0, -3.0, iso_vec3(22, -8, 563));
        struct iso_size size;
        rendered_head_clear(frame);
        rendered_head_draw(frame, model, NULL, sizes[i], &pose);
        assert_int_equal(iso_size_measure(sizer, frame, &start, &size), 0);
        print_message("size %.2f: %.3f\n", sizes[i], size.scale);
        assert_true(fabs(size.scale / sizes[i] - 1.0) < 0.02);
    }
    assert_true(fabs(iso_size_of_fit(model, model->mean_mm) - 1.0) < 1e-12);
    rendered_head_clear(frame);
    struct iso_rigid pose = rendered_head_pose(0, 0, iso_vec3(0, 0, 560));
    struct iso_size untouched = {.scale = 5.0};
    struct iso_relief relief = {.n_cells = 77};
    struct iso_sheet sheet = {.area_mm2 = 3.0};
    struct iso_sheet_finder *finder = NULL;
    assert_int_equal(iso_size_measure(sizer, frame, &pose, &untouched), -ENODATA);
    assert_true(untouched.scale == 5.0);
    assert_int_equal(iso_relief_measure(frame, &pose, &relief), -ENODATA);
    assert_int_equal(relief.n_cells, 77);
    assert_int_equal(iso_sheet_finder_new(0, &finder), -EINVAL);
    assert_int_equal(iso_sheet_finder_new(1000, &finder), 0);
    assert_int_equal(iso_sheet_find(finder, frame, 100.0, 1500.0, INFINITY, &sheet), -ENOSPC);
    iso_sheet_finder_free(finder);
    assert_int_equal(iso_sheet_finder_new(640 * 480, &finder), 0);
    assert_int_equal(iso_sheet_find(finder, frame, 100.0, 1500.0, INFINITY, &sheet), -ENOENT);
    assert_true(sheet.area_mm2 == 3.0);
    /* Of a wall, which nobody can hold, only the plane is fitted. */
    rendered_head_wall(frame, 800.0f);
    assert_int_equal(iso_sheet_find(finder, frame, 100.0, 1500.0, INFINITY, &sheet), 0);
    assert_true(sheet.flat.inlier_share > 0.99 && sheet.bent.inlier_share > 0.99);
    assert_int_equal(iso_sheet_find(finder, frame, 100.0, 1500.0, 130000.0, &sheet), 0);
    assert_true(sheet.flat.inlier_share > 0.99 && sheet.area_mm2 > 130000.0);
    assert_true(sheet.bent.inlier_share == 0.0 && sheet.border_share == 0.0);
    iso_sheet_finder_free(finder);
    iso_sizer_free(sizer);
    iso_frame_free(frame);
    iso_head_model_free(model);
    iso_sizer_free(NULL);
    iso_sheet_finder_free(NULL);
    iso_presentation_free(NULL);
}

/* Writes the mean head, moved by `by` standard deviations of one mode, to `shape`. */
static void move(const struct iso_head_model *model, uint32_t mode, double by,
                 struct iso_vec3 *shape)
{
    const float *m = &model->identity_mm[3 * (size_t)mode * model->n_vertices];
    for (size_t i = 0; i < model->n_vertices; i++) {
        struct iso_vec3 way = iso_vec3((double)m[3 * i], (double)m[3 * i + 1],
                                       (double)m[3 * i + 2]);
        shape[i] = iso_madd(model->mean_mm[i], by, way);
    }
}

static double scale_found(const struct iso_head_model *model, const struct iso_vec3 *shape,
                          double size)
{
    const struct iso_rigid pose = rendered_head_pose(4.0, -3.0, iso_vec3(10, -10, 560));
    struct iso_frame *frame = rendered_head_frame();
    struct iso_sizer *sizer = NULL;
    struct iso_size found;
    rendered_head_draw(frame, model, shape, size, &pose);
    assert_int_equal(iso_sizer_new(model, &sizer), 0);
    assert_int_equal(iso_size_measure(sizer, frame, &pose, &found), 0);
    iso_sizer_free(sizer);
    iso_frame_free(frame);
    return found.scale;
}

/* The head is large in the way in which people are large, so that the shape explains a part of its
 * size and the scale only the rest. A mean face that is printed large has the proportions of the
 * mean face, so that the scale explains all of its size. */
static void a_large_person_is_not_a_large_print(void **state)
{
    (void)state;
    struct iso_head_model *model = shipped_head_model();
    struct iso_vec3 *shape = calloc(model->n_vertices, sizeof *shape);
    double by = 0.0, size = 1.0;
    uint32_t mode = 0;
    assert_non_null(shape);
    for (uint32_t k = 0; k < 2 * 10; k++) { /* finds the mode that makes the head largest */
        double sigmas = k % 2 ? 3.0 : -3.0;
        move(model, k / 2, sigmas, shape);
        if (iso_size_of_fit(model, shape) > size) {
            size = iso_size_of_fit(model, shape);
            by = sigmas;
            mode = k / 2;
        }
    }
    move(model, mode, by, shape);
    double person = scale_found(model, shape, 1.0), print = scale_found(model, NULL, size);
    print_message("%.3f of the mean: a person %.3f, a print %.3f\n", size, person, print);
    assert_true(size > 1.05);
    assert_true(log(person) < 0.8 * log(size));
    assert_true(fabs(log(print / size)) < 0.02);
    free(shape);
    iso_head_model_free(model);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_plane_fits_a_plane),
        cmocka_unit_test(a_bent_sheet_fits_surfaces_that_bend_about_one_axis),
        cmocka_unit_test(every_cue_has_its_word),
        cmocka_unit_test(the_size_of_the_mean_face_is_found),
        cmocka_unit_test(a_large_person_is_not_a_large_print),
        cmocka_unit_test(pictures_and_masks_are_refused_and_people_are_not),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
