#include "sim/world/generate/studio.h"

#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "drivers/recording/recording_writer.h"
#include "sim/base/make_directory.h"
#include "sim/base/progress.h"
#include "sim/lab/methods/anthroface.h"

static const int64_t frame_period_ns = 33333333;

struct sim_studio {
    struct sim_studio_options options;
    struct sim_view *view;
    struct sim_sensor_workspace *workspace;
    struct iso_frame *frame;
    struct sim_corpus_row *rows;
    size_t n_rows, row_capacity;
    uint64_t key; /* key of the current recording */
};

int sim_studio_new(const struct sim_studio_options *options, struct sim_studio **out,
                   struct iso_fault *fault)
{
    const struct sim_sensor *sensor = options->sensor;
    int error = sim_make_directory(options->directory, fault);
    if (error) {
        return error;
    }
    struct sim_studio *studio = calloc(1, sizeof *studio);
    if (!studio) {
        return -ENOMEM;
    }
    studio->options = *options;
    error = sim_view_new(&sensor->camera, sensor->supersample, &studio->view);
    if (error == 0) {
        error = sim_sensor_workspace_new(sensor, &studio->workspace);
    }
    if (error == 0) {
        sim_sensor_attach(studio->workspace, studio->view);
    }
    if (error == 0) {
        error = iso_frame_new(&sensor->camera, sensor->camera.width_px, sensor->camera.height_px,
                              options->infrared, &studio->frame);
    }
    if (error != 0) {
        sim_studio_free(studio);
        return iso_fault_set(fault, error, "sensor %s: cannot be set up: %s", sensor->name,
                             strerror(-error));
    }
    *out = studio;
    return 0;
}

void sim_studio_free(struct sim_studio *studio)
{
    if (!studio) {
        return;
    }
    sim_view_free(studio->view);
    sim_sensor_workspace_free(studio->workspace);
    iso_frame_free(studio->frame);
    free(studio->rows);
    free(studio);
}

static int add_row(struct sim_studio *studio, const struct sim_corpus_row *row)
{
    if (studio->n_rows == studio->row_capacity) {
        const size_t capacity = 2 * studio->row_capacity + 64;
        struct sim_corpus_row *rows = realloc(studio->rows, capacity * sizeof *rows);
        if (!rows) {
            return -ENOMEM;
        }
        studio->rows = rows;
        studio->row_capacity = capacity;
    }
    studio->rows[studio->n_rows++] = *row;
    return 0;
}

static bool is_landmark(const char *name)
{
    for (int i = 0; i < ISO_LANDMARKS; i++) {
        if (strcmp(iso_landmark_name((enum iso_landmark)i), name) == 0) {
            return true;
        }
    }
    return false;
}

static int write_landmarks(struct sim_recording_writer *writer, const struct sim_truth *truth,
                           bool marks, struct iso_fault *fault)
{
    int error = 0;
    for (int i = 0; error == 0 && i < ISO_LANDMARKS; i++) {
        error = sim_recording_writer_landmark(writer, iso_landmark_name((enum iso_landmark)i),
                                              truth->landmark_mm[i], fault);
    }
    for (int i = 0; error == 0 && marks && i < SIM_MARKS; i++) {
        if (!is_landmark(sim_marks[i].name)) {
            error = sim_recording_writer_landmark(writer, sim_marks[i].name,
                                                  truth->ibug_mm[sim_marks[i].ibug], fault);
        }
    }
    return error;
}

/* The scene of a recording and the data to record it. */
struct take {
    sim_draw_frame *draw;
    void *scene;
    struct sim_random *random;
    bool frozen;
    struct sim_truth truth; /* of the frame that was measured last */
    bool truth_known;
};

static int measure_frame(struct sim_studio *studio, struct take *take, int index,
                         struct iso_fault *fault)
{
    take->truth_known = false;
    sim_view_clear(studio->view);
    const int error = take->draw(take->scene, index, studio->view, &take->truth,
                                 &take->truth_known);
    if (error != 0) {
        return iso_fault_set(fault, error, "frame %d: cannot be drawn: %s", index,
                             strerror(-error));
    }
    sim_view_finish(studio->view);
    sim_sensor_measure(studio->options.sensor, studio->view, studio->options.noise_scale,
                       take->random, studio->workspace, studio->frame);
    if (studio->options.infrared) {
        struct sim_random grain = sim_random_seeded(studio->key, sim_random_hash("infrared"),
                                                    (uint64_t)index);
        sim_infrared_measure(studio->options.sensor, studio->view, studio->options.noise_scale,
                             &grain, studio->workspace, studio->frame->intensity);
    }
    return 0;
}

static int record_frame(struct sim_studio *studio, struct sim_recording_writer *writer,
                        struct take *take, int index, struct iso_fault *fault)
{
    int error = take->frozen && index > 0 ? 0 : measure_frame(studio, take, index, fault);
    if (error != 0) {
        return error;
    }
    studio->frame->sequence = (uint64_t)index;
    studio->frame->t_ns = index * frame_period_ns;
    error = sim_recording_writer_append(writer, studio->frame, fault);
    if (error == 0 && take->truth_known) {
        error = write_landmarks(writer, &take->truth, studio->options.marks, fault);
    }
    return error;
}

static int record_take(struct sim_studio *studio, const struct sim_corpus_row *row,
                       struct take *take, struct iso_fault *fault)
{
    const struct sim_sensor *sensor = studio->options.sensor;
    struct iso_recording_meta meta = {.camera = sensor->camera, .unit_mm = sensor->unit_mm};
    (void)snprintf(meta.sensor, sizeof meta.sensor, "%s", sensor->name);
    char path[PATH_MAX];
    (void)snprintf(path, sizeof path, "%s/%s", studio->options.directory, row->recording);
    studio->key = sim_random_hash(row->recording);
    struct sim_recording_writer *writer = NULL;
    sim_sensor_begin(studio->workspace, take->random);
    int error = sim_recording_writer_create(path, &meta, studio->options.png_level, &writer, fault);
    for (int i = 0; error == 0 && i < (int)row->count; i++) {
        error = record_frame(studio, writer, take, i, fault);
    }
    if (error == 0) {
        error = sim_recording_writer_finish(writer, fault);
    }
    if (error == 0) {
        error = add_row(studio, row);
    }
    sim_recording_writer_free(writer);
    sim_progress_step(1);
    return error;
}

int sim_studio_record(struct sim_studio *studio, const struct sim_corpus_row *row,
                      sim_draw_frame *draw, void *scene, struct sim_random *random,
                      struct iso_fault *fault)
{
    struct take take = {.draw = draw, .scene = scene, .random = random};
    return record_take(studio, row, &take, fault);
}

int sim_studio_record_frozen(struct sim_studio *studio, const struct sim_corpus_row *row,
                             sim_draw_frame *draw, void *scene, struct sim_random *random,
                             struct iso_fault *fault)
{
    struct take take = {.draw = draw, .scene = scene, .random = random, .frozen = true};
    return record_take(studio, row, &take, fault);
}

int sim_studio_finish(struct sim_studio *studio, struct iso_fault *fault)
{
    return sim_corpus_write(studio->options.directory, studio->rows, studio->n_rows, fault);
}
