#include "sim/train/metric/train_cohort.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/match/cohort.h"
#include "sim/base/progress.h"
#include "sim/world/face/expression.h"
#include "sim/world/scene/room.h"
#include "sim/world/scene/sitter.h"

enum { DAYS = 3 /* on which a person may try */, PEOPLE_PER_TEMPLATE_MAX = 2 };

/* Stance before a door: standard deviation of each angle, and greatest offset of the nose from the
 * optical axis in x and in y. */
static const double angle_sd_rad = 0.07, off_axis_mm = 40.0;

/* A sensor, with the tools to take its frames and to extract templates from them. */
struct booth {
    const struct sim_sensor *sensor;
    struct sim_view *view;
    struct sim_sensor_workspace *workspace;
    struct iso_frame *frame;
    struct iso_extractor *extractor;
};

static void booth_done(struct booth *booth)
{
    sim_view_free(booth->view);
    sim_sensor_workspace_free(booth->workspace);
    iso_frame_free(booth->frame);
    iso_extractor_free(booth->extractor);
}

static int booth_init(struct booth *booth, const struct sim_sensor *sensor,
                      const struct sim_train_cohort_options *options)
{
    struct iso_extract_options extract = options->extract;
    (void)snprintf(extract.sensor, sizeof extract.sensor, "%s", sensor->name);
    extract.now_ns = NULL;
    booth->sensor = sensor;
    int error = sim_view_new(&sensor->camera, sensor->supersample, &booth->view);
    if (!error) {
        error = sim_sensor_workspace_new(sensor, &booth->workspace);
    }
    if (error == 0) {
        sim_sensor_attach(booth->workspace, booth->view);
    }
    if (!error) {
        error = iso_frame_new(&sensor->camera, sensor->camera.width_px, sensor->camera.height_px,
                              false, &booth->frame);
    }
    if (!error) {
        error = iso_extractor_new(options->model, &extract, &booth->extractor);
    }
    return error;
}

static struct sim_stance draw_stance(const struct sim_ict *ict, const struct sim_sensor *sensor,
                                     struct sim_random *random)
{
    const double off_axis = sensor->face_only ? 0.0 : off_axis_mm;
    struct sim_stance stance;
    stance.yaw_rad = angle_sd_rad * sim_random_normal(random);
    stance.pitch_rad = angle_sd_rad * sim_random_normal(random);
    stance.roll_rad = angle_sd_rad * sim_random_normal(random);
    stance.nose_mm.x = sim_random_between(random, -off_axis, off_axis);
    stance.nose_mm.y = sim_random_between(random, -off_axis, off_axis);
    stance.nose_mm.z = sim_random_between(random, sensor->distance_min_mm, sensor->distance_max_mm);
    const enum sim_expression expression = sim_random_below(random, 2) ? SIM_MILD : SIM_NEUTRAL;
    (void)sim_expression_draw(ict, expression, random, stance.expression);
    return stance;
}

/* Renders the person with a random stance, dress and room into the booth's frame. */
static int take_frame(struct booth *booth, const struct sim_ict *ict,
                      const struct sim_person *person, struct sim_random *random)
{
    const bool face_only = booth->sensor->face_only;
    struct sim_sitter_options dressed = {.hair = true, .torso = !face_only};
    struct sim_stance stance = draw_stance(ict, booth->sensor, random);
    struct sim_sitter *sitter = NULL;
    struct sim_room *room = NULL;
    int error = sim_sitter_new(ict, person, &dressed, random, &sitter);
    if (!error && !face_only) {
        error = sim_room_new(false, random, &room);
    }
    sim_view_clear(booth->view);
    if (!error && room) {
        error = sim_room_draw(room, booth->view);
    }
    if (!error) {
        error = sim_sitter_draw(sitter, &stance, booth->view, NULL);
    }
    if (!error) {
        sim_view_finish(booth->view);
        sim_sensor_begin(booth->workspace, random);
        sim_sensor_measure(booth->sensor, booth->view, 1.0, random, booth->workspace, booth->frame);
    }
    sim_room_free(room);
    sim_sitter_free(sitter);
    return error;
}

/* extraction->outcome is ISO_CAPTURE_OK if the person was accepted on one of the days. */
static int enrol(struct booth *booth, const struct sim_train_cohort_options *options,
                 uint32_t index, uint32_t *n_frames, struct iso_extraction *extraction)
{
    struct sim_person person = sim_person_draw(SIM_POPULATION_TRAIN, options->seed, index, 1.0);
    int error = 0;
    for (uint32_t day = 0; !error && day < DAYS; day++) {
        struct sim_random random = sim_random_seeded(options->seed, sim_random_hash("cohort"),
                                                     DAYS * index + day);
        error = take_frame(booth, options->ict, &person, &random);
        if (!error) {
            (*n_frames)++;
            error = iso_extractor_run(booth->extractor, booth->frame, extraction);
        }
        if (!error && extraction->outcome == ISO_CAPTURE_OK) {
            break;
        }
    }
    return error;
}

static int run(const struct sim_train_cohort_options *options, struct booth *booths,
               struct iso_template *templates, struct sim_train_cohort_report *report)
{
    struct iso_extraction *extraction = calloc(1, sizeof *extraction);
    if (!extraction) {
        return -ENOMEM;
    }
    uint32_t n = 0, n_frames = 0;
    int error = 0;
    const bool shown = sim_progress_begin("rendering the cohort", options->n_people);
    for (uint32_t person = 0;
         !error && n < options->n_people && person < PEOPLE_PER_TEMPLATE_MAX * options->n_people;
         person++) {
        struct booth *booth = &booths[n % (uint32_t)options->n_sensors];
        error = enrol(booth, options, person, &n_frames, extraction);
        if (!error && extraction->outcome == ISO_CAPTURE_OK) {
            templates[n++] = extraction->tmpl;
            sim_progress_step(1);
        }
    }
    sim_progress_end(shown);
    explicit_bzero(extraction, sizeof *extraction);
    free(extraction);
    if (!error && n < options->n_people) {
        error = -ENODATA;
    }
    *report = (struct sim_train_cohort_report){n, n_frames};
    return error;
}

int sim_train_cohort(const struct sim_train_cohort_options *options, struct iso_template **out,
                     struct sim_train_cohort_report *report, struct iso_fault *fault)
{
    if (options->n_sensors < 1 || options->n_sensors > SIM_COHORT_SENSORS_MAX ||
        options->n_people < ISO_COHORT_MIN || options->n_people > ISO_COHORT_MAX) {
        return iso_fault_set(fault, -EINVAL, "cohort: %d to %d people and 1 to %d sensors",
                             ISO_COHORT_MIN, ISO_COHORT_MAX, SIM_COHORT_SENSORS_MAX);
    }
    struct booth booths[SIM_COHORT_SENSORS_MAX] = {{0}};
    struct sim_train_cohort_report done;
    struct iso_template *templates = calloc(options->n_people, sizeof *templates);
    int error = templates ? 0 : -ENOMEM;
    for (int i = 0; !error && i < options->n_sensors; i++) {
        error = booth_init(&booths[i], options->sensors[i], options);
    }
    if (!error) {
        error = run(options, booths, templates, &done);
    }
    for (int i = 0; i < options->n_sensors; i++) {
        booth_done(&booths[i]);
    }
    if (error) {
        free(templates);
        return iso_fault_set(fault, error, "cohort: %s",
                             error == -ENODATA ? "too few faces are accepted" : strerror(-error));
    }
    *out = templates;
    *report = done;
    return 0;
}
