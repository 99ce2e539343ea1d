#include "sim/world/scene/depth_error.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "sim/base/progress.h"
#include "sim/world/scene/room.h"
#include "sim/world/scene/sitter.h"

static const double gross_mm = 5.0, pose_rad = 0.1745, sideways_mm = 30.0;

struct bench {
    const struct sim_depth_error_options *options;
    struct sim_view *view;
    struct sim_sensor_workspace *workspace;
    struct iso_frame *frame;
    float *errors_mm; /* of the measured pixels so far */
    size_t n_errors, capacity;
    struct sim_depth_error sum;
};

static int set_up(struct bench *b)
{
    const struct sim_sensor *sensor = b->options->sensor;
    int error = sim_view_new(&sensor->camera, sensor->supersample, &b->view);
    if (!error) {
        error = sim_sensor_workspace_new(sensor, &b->workspace);
    }
    if (!error) {
        sim_sensor_attach(b->workspace, b->view);
        error = iso_frame_new(&sensor->camera, sensor->camera.width_px, sensor->camera.height_px,
                              false, &b->frame);
    }
    b->capacity = (size_t)sensor->camera.width_px * (size_t)sensor->camera.height_px *
                  b->options->faces;
    b->errors_mm = error ? NULL : calloc(b->capacity, sizeof *b->errors_mm);
    return error || b->errors_mm ? error : -ENOMEM;
}

static void tear_down(struct bench *b)
{
    sim_view_free(b->view);
    sim_sensor_workspace_free(b->workspace);
    iso_frame_free(b->frame);
    free(b->errors_mm);
}

static void draw_stance(double distance_mm, struct sim_random *random, struct sim_stance *stance)
{
    memset(stance, 0, sizeof *stance);
    stance->yaw_rad = sim_random_between(random, -pose_rad, pose_rad);
    stance->pitch_rad = sim_random_between(random, -pose_rad, pose_rad);
    stance->roll_rad = sim_random_between(random, -pose_rad, pose_rad);
    stance->nose_mm.x = sim_random_between(random, -sideways_mm, sideways_mm);
    stance->nose_mm.y = sim_random_between(random, -sideways_mm, sideways_mm);
    stance->nose_mm.z = distance_mm;
}

static int draw(struct bench *b, const struct sim_stance *stance, size_t index,
                struct sim_random *random)
{
    const struct sim_ict *ict = b->options->ict;
    const bool face_only = b->options->sensor->face_only;
    struct sim_person person = sim_person_draw("depth-error", b->options->seed, (uint32_t)index,
                                               1.0);
    struct sim_sitter_options wears = {.hair = true, .torso = !face_only};
    struct sim_sitter *sitter = NULL;
    struct sim_room *room = NULL;
    sim_view_clear(b->view);
    int error = sim_sitter_new(ict, &person, &wears, random, &sitter);
    if (!error && !face_only) {
        error = sim_room_new(false, random, &room);
    }
    if (!error && room) {
        error = sim_room_draw(room, b->view);
    }
    if (!error) {
        error = sim_sitter_draw(sitter, stance, b->view, NULL);
    }
    sim_view_finish(b->view);
    sim_room_free(room);
    sim_sitter_free(sitter);
    return error;
}

static void compare(struct bench *b, struct iso_vec3 nose_mm)
{
    const struct sim_view *view = b->view;
    const int s = view->supersample;
    for (int row = 0; row < b->frame->height_px; row++) {
        for (int column = 0; column < b->frame->width_px; column++) {
            const int u = column * s + s / 2, v = row * s + s / 2;
            const size_t i = (size_t)v * (size_t)view->camera.width_px + (size_t)u;
            if (view->material[i] != SIM_SKIN) {
                continue;
            }
            const double z_mm = (double)view->depth_mm[i];
            struct iso_vec3 point = iso_camera_back_project(&view->camera, u, v, z_mm);
            if (iso_norm(iso_sub(point, nose_mm)) > SIM_DEPTH_ERROR_RADIUS_MM) {
                continue;
            }
            const double measured_mm = (double)iso_frame_depth_at(b->frame, column, row);
            b->sum.pixels++;
            if (measured_mm > 0.0) {
                b->errors_mm[b->n_errors++] = (float)(measured_mm - z_mm);
            } else {
                b->sum.holes++;
            }
        }
    }
}

static int by_size(const void *a, const void *b)
{
    const float x = fabsf(*(const float *)a), y = fabsf(*(const float *)b);
    return (x > y) - (x < y);
}

static void sum_up(struct bench *b)
{
    double sum = 0.0, squares = 0.0, n = (double)b->n_errors;
    size_t gross = 0;
    for (size_t i = 0; i < b->n_errors; i++) {
        const double error = (double)b->errors_mm[i];
        sum += error;
        squares += error * error;
        gross += fabs(error) > gross_mm;
    }
    qsort(b->errors_mm, b->n_errors, sizeof *b->errors_mm, by_size);
    b->sum.bias_mm = sum / n;
    b->sum.rms_mm = sqrt(squares / n);
    b->sum.median_mm = (double)fabsf(b->errors_mm[b->n_errors / 2]);
    b->sum.p95_mm = (double)fabsf(b->errors_mm[b->n_errors * 95 / 100]);
    b->sum.gross = (double)gross / n;
}

int sim_depth_error_measure(const struct sim_depth_error_options *options, double distance_mm,
                            struct sim_depth_error *out, struct iso_fault *fault)
{
    struct bench bench = {.options = options,
                          .sum = {.distance_mm = distance_mm, .faces = options->faces}};
    int error = set_up(&bench);
    for (size_t i = 0; !error && i < options->faces; i++, sim_progress_step(1)) {
        struct sim_random random = sim_random_seeded(options->seed, (uint64_t)distance_mm, i);
        struct sim_stance stance;
        draw_stance(distance_mm, &random, &stance);
        error = draw(&bench, &stance, i, &random);
        if (!error) {
            sim_sensor_begin(bench.workspace, &random);
            sim_sensor_measure(options->sensor, bench.view, options->noise_scale, &random,
                               bench.workspace, bench.frame);
            compare(&bench, stance.nose_mm);
            if (options->show) {
                options->show(options->context, bench.view, bench.frame);
            }
        }
    }
    if (error) {
        (void)iso_fault_set(fault, error, "sensor %s: %s", options->sensor->name, strerror(-error));
    } else if (bench.n_errors == 0) {
        error = iso_fault_set(fault, -EINVAL, "sensor %s measures nothing at %g mm",
                              options->sensor->name, distance_mm);
    } else {
        sum_up(&bench);
        *out = bench.sum;
    }
    tear_down(&bench);
    return error;
}
