#include "drivers/recording/recording_writer.h"

#include <dirent.h>
#include <errno.h>
#include <inttypes.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "drivers/base/path.h"
#include "drivers/file/png.h"
#include "drivers/recording/recording_ini.h"

struct sim_recording_writer {
    char *directory;
    struct iso_recording_meta meta;
    int png_level;
    size_t frames;
    int64_t last_t_ns;
    bool intensity;
    FILE *depth_list, *intensity_list, *landmarks; /* the last two are opened when first needed */
    uint16_t *counts;                              /* room for one plane */
};

struct iso_camera sim_recording_camera(const struct iso_frame *frame)
{
    struct iso_camera camera = frame->camera;
    camera.width_px = frame->width_px;
    camera.height_px = frame->height_px;
    camera.cx_px -= frame->crop_x_px;
    camera.cy_px -= frame->crop_y_px;
    return camera;
}

static bool cameras_equal(const struct iso_camera *a, const struct iso_camera *b)
{
    return a->projection == b->projection && a->width_px == b->width_px &&
           a->height_px == b->height_px && a->fx_px == b->fx_px && a->fy_px == b->fy_px &&
           a->pitch_mm == b->pitch_mm && a->cx_px == b->cx_px && a->cy_px == b->cy_px &&
           a->k1 == b->k1 && a->k2 == b->k2 && a->k3 == b->k3 && a->p1 == b->p1 && a->p2 == b->p2;
}

/* ---- files ------------------------------------------------------------------ */

static int make_directory(const struct sim_recording_writer *writer, const char *file,
                          struct iso_fault *fault)
{
    char path[PATH_MAX];
    int error = iso_path_join(writer->directory, file, path, fault);
    if (!error && mkdir(path, 0777) != 0) {
        error = iso_fault_set(fault, -errno, "%s: %m", path);
    }
    return error;
}

static int open_text(const struct sim_recording_writer *writer, const char *file, FILE **out,
                     struct iso_fault *fault)
{
    char path[PATH_MAX];
    const int error = iso_path_join(writer->directory, file, path, fault);
    if (!error) {
        FILE *stream = fopen(path, "wxe");
        if (!stream) {
            return iso_fault_set(fault, -errno, "%s: %m", path);
        }
        *out = stream;
    }
    return error;
}

static int write_failed(const struct sim_recording_writer *writer, struct iso_fault *fault)
{
    return iso_fault_set(fault, errno ? -errno : -EIO, "%s: %m", writer->directory);
}

static int close_text(const struct sim_recording_writer *writer, FILE **stream,
                      struct iso_fault *fault)
{
    FILE *closing = *stream;
    *stream = NULL;
    if (closing && fclose(closing) != 0) {
        return iso_fault_set(fault, -errno, "%s: %m", writer->directory);
    }
    return 0;
}

/* ---- creating --------------------------------------------------------------- */

/* Makes the recording's directory, or uses an existing one if it is empty. */
static int claim_directory(const char *directory, struct iso_fault *fault)
{
    int error = 0, entries = 0;
    if (mkdir(directory, 0777) == 0) {
        return 0;
    }
    if (errno != EEXIST) {
        return iso_fault_set(fault, -errno, "%s: %m", directory);
    }
    DIR *listing = opendir(directory);
    if (!listing) {
        return iso_fault_set(fault, -errno, "%s: %m", directory);
    }
    while (readdir(listing)) {
        entries++;
    }
    if (entries > 2) { /* "." and ".." are always there */
        error = iso_fault_set(fault, -EEXIST, "%s: is not empty", directory);
    }
    (void)closedir(listing);
    return error;
}

static int write_ini(const struct sim_recording_writer *writer, struct iso_fault *fault)
{
    FILE *ini = NULL;
    int error = open_text(writer, "recording.ini", &ini, fault);
    if (error) {
        return error;
    }
    if (sim_recording_ini_print(ini, &writer->meta)) {
        error = iso_fault_set(fault, -EIO, "%s/recording.ini: %m", writer->directory);
    }
    const int close_error = close_text(writer, &ini, error ? NULL : fault);
    return error ? error : close_error;
}

static int prepare_directory(struct sim_recording_writer *writer, struct iso_fault *fault)
{
    int error = claim_directory(writer->directory, fault);
    if (!error) {
        error = write_ini(writer, fault);
    }
    if (!error) {
        error = make_directory(writer, "depth", fault);
    }
    if (!error) {
        error = open_text(writer, "depth.txt", &writer->depth_list, fault);
    }
    if (!error) {
        errno = 0;
        if (fputs("# timestamp_s filename\n", writer->depth_list) < 0) {
            error = write_failed(writer, fault);
        }
    }
    return error;
}

int sim_recording_writer_create(const char *directory, const struct iso_recording_meta *meta,
                                int png_level, struct sim_recording_writer **out,
                                struct iso_fault *fault)
{
    struct iso_fault why = {.text = "png_level must be 1..9"};
    if (iso_recording_meta_check(meta, &why) || png_level < 1 || png_level > 9) {
        return iso_fault_set_code(fault, why.code, -EINVAL, "%s: %s", directory, why.text);
    }
    struct sim_recording_writer *writer = calloc(1, sizeof *writer);
    const size_t pixels = (size_t)meta->camera.width_px * (size_t)meta->camera.height_px;
    int error = -ENOMEM;
    if (writer) {
        writer->meta = *meta;
        writer->png_level = png_level;
        writer->last_t_ns = -1;
        writer->directory = strdup(directory);
        writer->counts = calloc(pixels, sizeof *writer->counts);
    }
    if (!writer || !writer->directory || !writer->counts) {
        (void)iso_fault_set(fault, -ENOMEM, "%s: out of memory", directory);
    } else {
        error = prepare_directory(writer, fault);
    }
    if (error) {
        sim_recording_writer_free(writer);
        return error;
    }
    *out = writer;
    return 0;
}

/* ---- frames ----------------------------------------------------------------- */

static int check_frame(const struct sim_recording_writer *writer, const struct iso_frame *frame,
                       struct iso_fault *fault)
{
    struct iso_fault why;
    struct iso_camera camera = sim_recording_camera(frame);
    if (!cameras_equal(&camera, &writer->meta.camera)) {
        (void)iso_fault_set(&why, -EINVAL, "another camera");
    } else if (frame->t_ns < 0 || frame->t_ns <= writer->last_t_ns) {
        (void)iso_fault_set(&why, -EINVAL, "time does not rise");
    } else if (writer->frames > 0 && writer->intensity != (frame->intensity != NULL)) {
        (void)iso_fault_set(&why, -EINVAL, "intensity in some frames only");
    } else if (iso_frame_check(frame, &why) == 0) {
        return 0;
    }
    return iso_fault_set_code(fault, why.code, -EINVAL, "%s: frame %zu: %s", writer->directory,
                              writer->frames, why.text);
}

static int count_depths(const struct sim_recording_writer *writer, const struct iso_frame *frame,
                        struct iso_fault *fault)
{
    const size_t pixels = (size_t)frame->width_px * (size_t)frame->height_px;
    for (size_t i = 0; i < pixels; i++) {
        const double depth_mm = (double)frame->depth_mm[i];
        const double count = round(depth_mm / writer->meta.unit_mm);
        if (count > UINT16_MAX || (depth_mm > 0.0 && count < 1.0)) {
            return iso_fault_set(fault, -ERANGE,
                                 "%s: frame %zu: depth %g mm does not fit 16 bits of %g mm",
                                 writer->directory, writer->frames, depth_mm, writer->meta.unit_mm);
        }
        writer->counts[i] = (uint16_t)count;
    }
    return 0;
}

static int count_intensities(const struct sim_recording_writer *writer,
                             const struct iso_frame *frame, struct iso_fault *fault)
{
    const size_t pixels = (size_t)frame->width_px * (size_t)frame->height_px;
    for (size_t i = 0; i < pixels; i++) {
        const float value = frame->intensity[i];
        if (!(value >= 0.0F && value <= 1.0F)) {
            return iso_fault_set(fault, -EINVAL, "%s: frame %zu: intensity outside 0..1",
                                 writer->directory, writer->frames);
        }
        writer->counts[i] = (uint16_t)lround((double)value * UINT16_MAX);
    }
    return 0;
}

/* Writes writer->counts as FOLDER/NNNNNN.png. */
static int write_plane(const struct sim_recording_writer *writer, const char *folder,
                       struct iso_fault *fault)
{
    char path[PATH_MAX], file[64];
    struct iso_image image = {
        .width_px = writer->meta.camera.width_px,
        .height_px = writer->meta.camera.height_px,
        .pixel = ISO_PIXEL_GREY16,
        .samples = writer->counts,
    };
    (void)snprintf(file, sizeof file, "%s/%06zu.png", folder, writer->frames);
    const int error = iso_path_join(writer->directory, file, path, fault);
    return error ? error : iso_png_write(path, &image, writer->png_level, fault);
}

static int list_plane(const struct sim_recording_writer *writer, const char *folder, FILE *list,
                      int64_t t_ns, struct iso_fault *fault)
{
    errno = 0;
    const int length = fprintf(list, "%" PRId64 ".%09" PRId64 " %s/%06zu.png\n", t_ns / 1000000000,
                               t_ns % 1000000000, folder, writer->frames);
    return length < 0 ? write_failed(writer, fault) : 0;
}

static int write_intensity(struct sim_recording_writer *writer, const struct iso_frame *frame,
                           struct iso_fault *fault)
{
    int error = count_intensities(writer, frame, fault);
    if (!error && !writer->intensity_list) {
        error = make_directory(writer, "ir", fault);
        if (!error) {
            error = open_text(writer, "ir.txt", &writer->intensity_list, fault);
        }
    }
    return error ? error : write_plane(writer, "ir", fault);
}

/* The lists are written last, so that they do not name a frame that was refused after some of its
 * files had been written. */
int sim_recording_writer_append(struct sim_recording_writer *writer, const struct iso_frame *frame,
                                struct iso_fault *fault)
{
    int error = check_frame(writer, frame, fault);
    if (!error) {
        error = count_depths(writer, frame, fault);
    }
    if (!error) {
        error = write_plane(writer, "depth", fault);
    }
    if (!error && frame->intensity) {
        error = write_intensity(writer, frame, fault);
    }
    if (!error) {
        error = list_plane(writer, "depth", writer->depth_list, frame->t_ns, fault);
    }
    if (!error && frame->intensity) {
        error = list_plane(writer, "ir", writer->intensity_list, frame->t_ns, fault);
    }
    if (!error) {
        writer->intensity = frame->intensity != NULL;
        writer->last_t_ns = frame->t_ns;
        writer->frames++;
    }
    return error;
}

int sim_recording_writer_landmark(struct sim_recording_writer *writer, const char *name,
                                  struct iso_vec3 point_mm, struct iso_fault *fault)
{
    static const char allowed[] =
        "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-";
    const size_t length = strlen(name);
    if (writer->frames == 0 || length < 1 || length >= ISO_RECORDING_LANDMARK_MAX ||
        strspn(name, allowed) != length || !isfinite(point_mm.x + point_mm.y + point_mm.z)) {
        return iso_fault_set(fault, -EINVAL, "%s: landmark that cannot be written",
                             writer->directory);
    }
    errno = 0;
    if (!writer->landmarks) {
        const int error = open_text(writer, "landmarks.csv", &writer->landmarks, fault);
        if (error) {
            return error;
        }
        /* ferror() below detects an error. */
        (void)fputs("frame,name,x_mm,y_mm,z_mm\n", writer->landmarks);
    }
    const int printed = fprintf(writer->landmarks, "%zu,%s,%.4f,%.4f,%.4f\n", writer->frames - 1,
                                name, point_mm.x, point_mm.y, point_mm.z);
    return printed < 0 || ferror(writer->landmarks) ? write_failed(writer, fault) : 0;
}

/* ---- ending ----------------------------------------------------------------- */

int sim_recording_writer_finish(struct sim_recording_writer *writer, struct iso_fault *fault)
{
    FILE **streams[] = {&writer->depth_list, &writer->intensity_list, &writer->landmarks};
    int first = 0;
    for (size_t i = 0; i < sizeof streams / sizeof *streams; i++) {
        const int error = close_text(writer, streams[i], first ? NULL : fault);
        if (!first) {
            first = error;
        }
    }
    if (!first && writer->frames == 0) {
        first = iso_fault_set(fault, -ENODATA, "%s: no frames were written", writer->directory);
    }
    return first;
}

void sim_recording_writer_free(struct sim_recording_writer *writer)
{
    if (writer) {
        (void)close_text(writer, &writer->depth_list, NULL);
        (void)close_text(writer, &writer->intensity_list, NULL);
        (void)close_text(writer, &writer->landmarks, NULL);
        free(writer->counts);
        free(writer->directory);
        free(writer);
    }
}
