#include "sim/shapes/make/crops.h"

#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/surface/clean.h"
#include "isotherm/shape.h"
#include "isotherm/triangulate.h"
#include "sim/base/make_directory.h"
#include "sim/base/progress.h"
#include "sim/lab/match/capture.h"
#include "sim/shapes/make/manifest.h"
#include "sim/shapes/mesh/mesh_writer.h"

enum { CROP_PX_MAX = 1 << 18, DEPTH_MAX_MM = 4096 };
static const double slab_mm = 80.0, radius_mm = 100.0, pitch_mm = 4.0, jump_mm = 20.0;

struct cutter {
    const struct sim_crops_options *options;
    struct iso_cleaner *cleaner;
    struct iso_triangulator *triangulator;
    struct iso_coloured_mesh crop;
    struct sim_shape_row *rows;
    int32_t n, n_empty;
    /* [DEPTH_MAX_MM] number of the frame's pixels for each millimetre of depth. */
    int32_t *pixels_at;
};

/* The depth, in whole millimetres, below which a hundredth of the measured depths are; 0 if no
 * pixel is measured. */
static int foremost_mm(struct cutter *cutter, const struct iso_frame *frame)
{
    static const size_t share = 100;
    int32_t *count = cutter->pixels_at;
    size_t total = 0, sum = 0;
    memset(count, 0, DEPTH_MAX_MM * sizeof *count);
    for (int i = 0; i < frame->width_px * frame->height_px; i++) {
        float z = frame->depth_mm[i];
        if (z > 0.0f && z < (float)DEPTH_MAX_MM) {
            count[(int)z]++;
            total++;
        }
    }
    int z = 0;
    while (z + 1 < DEPTH_MAX_MM && sum * share < total) {
        sum += (size_t)count[z++];
    }
    return z;
}

/* The middle of the nearest object; false if there is none. */
static bool find_centre(struct cutter *cutter, const struct iso_frame *frame, struct iso_vec3 *out)
{
    double front_mm = foremost_mm(cutter, frame), n = 0.0;
    struct iso_vec3 sum = {0.0, 0.0, 0.0};
    for (int i = 0; i < frame->width_px * frame->height_px; i++) {
        const double z = (double)frame->depth_mm[i];
        if (z > 0.0 && z <= front_mm + slab_mm) {
            sum = iso_add(sum, iso_frame_point_at(frame, i % frame->width_px, i / frame->width_px));
            n += 1.0;
        }
    }
    if (n > 0.0) {
        *out = iso_scale(1.0 / n, sum);
    }
    return n > 0.0;
}

/* Converts from the camera's frame (y down, z away) to the viewer's frame (y up, z towards the
 * viewer). */
static void turn_to_viewer(struct iso_mesh *mesh)
{
    for (int32_t i = 0; i < mesh->n_vertices; i++) {
        struct iso_vec3 p = mesh->vertices_mm[i];
        mesh->vertices_mm[i] = iso_vec3(p.x, -p.y, -p.z);
    }
}

/* Fills cutter->crop. -ENODATA if there are too few pixels. */
static int cut_crop(struct cutter *cutter, const struct iso_frame *frame)
{
    const struct iso_frame *part;
    struct iso_vec3 centre_mm;
    if (!find_centre(cutter, frame, &centre_mm)) {
        return -ENODATA;
    }
    int error = iso_clean(cutter->cleaner, frame, centre_mm, radius_mm, pitch_mm, &part);
    if (!error) {
        error = iso_triangulate(cutter->triangulator, part, cutter->crop.mesh);
    }
    if (!error) {
        turn_to_viewer(cutter->crop.mesh);
    }
    return error || cutter->crop.mesh->n_vertices >= ISO_SHAPE_VERTICES_MIN ? error : -ENODATA;
}

static int keep_crop(struct cutter *cutter, size_t corpus, const struct sim_corpus_row *from,
                     struct iso_fault *fault)
{
    char path[PATH_MAX];
    struct sim_shape_row *row = &cutter->rows[cutter->n];
    const int named = snprintf(row->file, sizeof row->file, "%zu-%s-%zu.off", corpus,
                               from->recording, from->first);
    (void)snprintf(row->class_name, sizeof row->class_name, "%s",
                   strcmp(from->subject, "none") == 0 ? "not-face" : "face");
    const int length = snprintf(path, sizeof path, "%s/%s", cutter->options->out, row->file);
    if ((size_t)named >= sizeof row->file || (size_t)length >= sizeof path) {
        return iso_fault_set(fault, -ENAMETOOLONG, "%s: the name is too long", from->recording);
    }
    const int error = sim_mesh_write(path, &cutter->crop, fault);
    cutter->n += error == 0;
    return error;
}

/* A frame without a nearest object is counted and skipped. */
static int cut_and_keep(struct cutter *cutter, size_t corpus, const struct sim_corpus_row *row,
                        const struct iso_frame *frame, struct iso_fault *fault)
{
    const int error = cut_crop(cutter, frame);
    if (error == -ENODATA) {
        cutter->n_empty++;
        return 0;
    }
    if (error) {
        return iso_fault_set(fault, error, "%s: %s", row->recording, strerror(-error));
    }
    return keep_crop(cutter, corpus, row, fault);
}

static int cut_row(struct cutter *cutter, size_t corpus, const struct sim_corpus_row *row,
                   struct iso_fault *fault)
{
    struct iso_recording *recording = NULL;
    struct iso_frame *frame = NULL;
    int error = sim_recording_open(cutter->options->corpora.text[corpus], row->recording,
                                   &recording, fault);
    if (error) {
        return error;
    }
    error = iso_recording_frame_new(recording, &frame);
    if (error) {
        (void)iso_fault_set(fault, error, "%s: out of memory", row->recording);
    } else {
        error = iso_recording_read(recording, row->first, frame, fault);
    }
    if (!error) {
        error = cut_and_keep(cutter, corpus, row, frame, fault);
    }
    iso_frame_free(frame);
    iso_recording_close(recording);
    return error;
}

static int cut_corpus(struct cutter *cutter, size_t number, struct iso_fault *fault)
{
    struct sim_corpus *corpus = NULL;
    int error = sim_corpus_read(cutter->options->corpora.text[number], &corpus, fault);
    if (error) {
        return error;
    }
    size_t wanted = cutter->options->rows, n = corpus->n_rows;
    wanted = wanted > 0 && wanted < n ? wanted : n;
    struct sim_shape_row *rows = realloc(cutter->rows, ((size_t)cutter->n + wanted) * sizeof *rows);
    if (rows) {
        cutter->rows = rows;
    } else {
        error = iso_fault_set(fault, -ENOMEM, "%s: out of memory",
                              cutter->options->corpora.text[number]);
    }
    const bool shown = sim_progress_begin("cutting out faces and other objects", wanted);
    for (size_t i = 0; !error && i < wanted; i++) {
        error = cut_row(cutter, number, &corpus->rows[i * n / wanted], fault);
        sim_progress_step(1);
    }
    sim_progress_end(shown);
    sim_corpus_free(corpus);
    return error;
}

static int make_room(struct cutter *cutter)
{
    const struct iso_triangulate_options triangulate = {.jump_mm = jump_mm, .largest_only = true};
    cutter->pixels_at = calloc(DEPTH_MAX_MM, sizeof *cutter->pixels_at);
    int error = cutter->pixels_at ? iso_cleaner_new(CROP_PX_MAX, &cutter->cleaner) : -ENOMEM;
    if (!error) {
        error = iso_triangulator_new(CROP_PX_MAX, &triangulate, &cutter->triangulator);
    }
    if (error) {
        return error;
    }
    return iso_mesh_new(CROP_PX_MAX, 2 * CROP_PX_MAX, &cutter->crop.mesh);
}

int sim_crops_write(const struct sim_crops_options *options, int32_t *n_written, int32_t *n_empty,
                    struct iso_fault *fault)
{
    struct cutter cutter = {.options = options};
    if (options->corpora.n == 0) {
        return iso_fault_set(fault, -EINVAL, "one or more corpora are needed");
    }
    int error = sim_make_directory(options->out, fault);
    if (error) {
        return error;
    }
    error = make_room(&cutter);
    if (error) {
        (void)iso_fault_set(fault, error, "out of memory");
    }
    for (size_t i = 0; !error && i < options->corpora.n; i++) {
        error = cut_corpus(&cutter, i, fault);
    }
    if (!error) {
        error = sim_shape_manifest_write(options->out, cutter.rows, cutter.n, fault);
    }
    iso_cleaner_free(cutter.cleaner);
    iso_triangulator_free(cutter.triangulator);
    iso_coloured_mesh_done(&cutter.crop);
    free(cutter.pixels_at);
    free(cutter.rows);
    if (!error) {
        *n_written = cutter.n;
        *n_empty = cutter.n_empty;
    }
    return error;
}
