/* A recogniser learns the records of the outline stream. It must not tell people apart; the same
 * recogniser does so by their plain silhouettes, which shows that it could. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "drivers/model/model_file.h"
#include "isotherm/extract.h"
#include "sim/base/random.h"
#include "sim/lab/outline/outline_study.h"
#include "sim/world/view/view.h"

enum { PEOPLE = 16, LEARNED = 6, NAMED = 8, FRAMES = LEARNED + NAMED };

static const struct iso_camera camera = {.projection = ISO_PINHOLE,
                                         .width_px = 320,
                                         .height_px = 240,
                                         .fx_px = 290,
                                         .fy_px = 290,
                                         .cx_px = 159.5,
                                         .cy_px = 119.5};

struct studio {
    struct iso_head_model *model;
    struct iso_extractor *extractor;
    struct iso_head_outline head;
    struct sim_view *view;
    struct iso_frame *frame;
    struct iso_vec3 *face_mm, *camera_mm;
    struct iso_extraction extraction;
};

/* A person: the mean head with random coefficients of identity. */
static void make_person(struct studio *s, struct sim_random *random)
{
    const struct iso_head_model *model = s->model;
    memcpy(s->face_mm, model->mean_mm, model->n_vertices * sizeof *s->face_mm);
    for (uint32_t i = 0; i < model->n_identity; i++) {
        const double weight = sim_random_normal(random);
        for (uint32_t v = 0; v < model->n_vertices; v++) {
            const float *mode = model->identity_mm + (size_t)3 * (i * model->n_vertices + v);
            s->face_mm[v] = iso_add(s->face_mm[v],
                                    iso_vec3(weight * (double)mode[0], weight * (double)mode[1],
                                             weight * (double)mode[2]));
        }
    }
}

static struct iso_mat3 turned(double yaw, double pitch, double roll)
{
    const double cy = cos(yaw), sy = sin(yaw), cp = cos(pitch), sp = sin(pitch), cr = cos(roll),
                 sr = sin(roll);
    /* Facing the camera (x right, y down, z away), then turned about y, x and z. */
    const struct iso_mat3 facing = {{{cy * cr, -cy * sr, sy},
                                     {-sp * sy * cr - cp * sr, sp * sy * sr - cp * cr, sp * cy},
                                     {cp * sy * cr - sp * sr, -cp * sy * sr - sp * cr, -cp * cy}}};
    return facing;
}

/* Takes a frame of the person in a random pose, which does not depend on the person. */
static void take_frame(struct studio *s, struct sim_random *random)
{
    const struct iso_rigid pose = {
        .rotation = turned(sim_random_between(random, -0.3, 0.3),
                           sim_random_between(random, -0.2, 0.2),
                           sim_random_between(random, -0.15, 0.15)),
        .translation_mm = {sim_random_between(random, -60, 60), sim_random_between(random, -40, 40),
                           sim_random_between(random, 500, 800)},
    };
    for (uint32_t v = 0; v < s->model->n_vertices; v++) {
        s->camera_mm[v] = iso_rigid_apply(&pose, s->face_mm[v]);
    }
    sim_view_clear(s->view);
    assert_int_equal(
        sim_view_draw(s->view, s->camera_mm, s->model->triangles, s->model->n_triangles, SIM_SKIN),
        0);
    sim_view_finish(s->view);
    memcpy(s->frame->depth_mm, s->view->depth_mm,
           (size_t)camera.width_px * (size_t)camera.height_px * sizeof(float));
    assert_int_equal(iso_extractor_run(s->extractor, s->frame, &s->extraction), 0);
}

static void open_studio(struct studio *s)
{
    const struct iso_extract_options options = iso_extract_options_default();
    assert_int_equal(
        iso_head_model_load(ISOTHERM_SOURCE_DIR "/core/data/head.model", &s->model, NULL), 0);
    assert_int_equal(iso_extractor_new(s->model, &options, &s->extractor), 0);
    assert_int_equal(sim_view_new(&camera, 1, &s->view), 0);
    assert_int_equal(iso_frame_new(&camera, camera.width_px, camera.height_px, false, &s->frame),
                     0);
    s->face_mm = calloc(s->model->n_vertices, sizeof *s->face_mm);
    s->camera_mm = calloc(s->model->n_vertices, sizeof *s->camera_mm);
    assert_true(s->face_mm && s->camera_mm);
    iso_head_outline_init(&s->head, s->model);
}

static void close_studio(struct studio *s)
{
    free(s->camera_mm);
    free(s->face_mm);
    iso_frame_free(s->frame);
    sim_view_free(s->view);
    iso_extractor_free(s->extractor);
    iso_head_model_free(s->model);
    free(s);
}

struct samples {
    struct sim_outline_sample gallery[PEOPLE * LEARNED], probes[PEOPLE * NAMED];
};

static void take_person(struct studio *s, size_t person, struct sim_random *random,
                        struct samples *views)
{
    make_person(s, random);
    for (size_t i = 0; i < FRAMES; i++) {
        do { /* a head at the edge of the picture may have no fit */
            take_frame(s, random);
        } while (!s->extraction.fitted);
        for (int view = 0; view < SIM_OUTLINE_VIEWS; view++) {
            struct sim_outline_sample *to = i < LEARNED
                                                ? &views[view].gallery[person * LEARNED + i]
                                                : &views[view].probes[person * NAMED + i - LEARNED];
            to->subject = person;
            assert_true(sim_outline_features_of(&s->head, &s->extraction.camera_from_face, s->frame,
                                                (enum sim_outline_view)view, &to->features));
        }
    }
}

static void the_stream_does_not_tell_people_apart(void **state)
{
    struct studio *s = calloc(1, sizeof *s);
    struct samples *views = calloc(SIM_OUTLINE_VIEWS, sizeof *views);
    struct sim_random random = sim_random_seeded(7, 1, 0);
    struct sim_outline_result result[SIM_OUTLINE_VIEWS];
    (void)state;
    assert_true(s && views);
    open_studio(s);
    for (size_t person = 0; person < PEOPLE; person++) {
        take_person(s, person, &random, views);
    }
    for (int view = 0; view < SIM_OUTLINE_VIEWS; view++) {
        assert_int_equal(sim_outline_recognise(views[view].gallery, PEOPLE * LEARNED,
                                               views[view].probes, PEOPLE * NAMED, &result[view]),
                         0);
        print_message("%s: %.1f %% (%.1f to %.1f)\n",
                      sim_outline_view_name((enum sim_outline_view)view), 100.0 * result[view].rate,
                      100.0 * result[view].interval.low, 100.0 * result[view].interval.high);
    }
    const double chance = 1.0 / PEOPLE;
    assert_true(result[SIM_OUTLINE_STREAM].interval.low <= chance);
    assert_true(result[SIM_OUTLINE_NO_FACE].interval.low <= chance);
    assert_true(result[SIM_OUTLINE_PLAIN].interval.low > chance);
    close_studio(s);
    free(views);
}

static void the_recogniser_recognises(void **state)
{
    struct sim_outline_sample gallery[4] = {
        {.subject = 0}, {.subject = 0}, {.subject = 1}, {.subject = 1}};
    struct sim_outline_sample probes[3] = {{.subject = 0}, {.subject = 1}, {.subject = 1}};
    struct sim_outline_result result;
    (void)state;
    gallery[2].features.window[3][3] = gallery[3].features.window[3][3] = 1.0F;
    probes[1].features.window[3][3] = 1.0F;
    assert_int_equal(sim_outline_recognise(gallery, 4, probes, 3, &result), 0);
    assert_int_equal(result.people, 2);
    assert_int_equal(result.right, 2); /* the last probe looks like the other person */
    assert_true(fabs(result.rate - 0.75) < 1e-12);
    assert_int_equal(sim_outline_recognise(gallery, 2, probes, 3, &result), -22);
    assert_int_equal(sim_outline_recognise(gallery, 4, probes, 0, &result), -22);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_recogniser_recognises),
        cmocka_unit_test(the_stream_does_not_tell_people_apart),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
