#include "drivers/recording/recording.h"

#include <errno.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>

#include "drivers/base/path.h"
#include "drivers/file/png.h"
#include "drivers/file/text.h"
#include "drivers/recording/frame_list.h"
#include "drivers/recording/recording_directory.h"

enum { INI_BYTES_MAX = 64 << 10, MATCH_NS = 1000000 };

struct iso_recording {
    char *directory;
    struct iso_recording_meta meta;
    struct iso_frame_list depth;
    struct iso_frame_list intensity; /* n = 0: there is no intensity */
    enum iso_pixel intensity_pixels; /* the set of pixel types that the intensity files may have */
    size_t *intensity_of; /* [depth.n]: entry of the intensity list for each depth frame */
    struct iso_image depth_image, intensity_image; /* reused for every frame */
};

/* ---- opening ---------------------------------------------------------------- */

static int read_meta(struct iso_recording *recording, struct iso_fault *fault)
{
    char path[PATH_MAX], *text = NULL;
    int error = iso_path_join(recording->directory, "recording.ini", path, fault);
    if (!error) {
        error = iso_text_read(path, INI_BYTES_MAX, &text, fault);
    }
    if (!error) {
        error = iso_recording_meta_parse(path, text, &recording->meta, fault);
    }
    free(text);
    return error;
}

static int read_list(const struct iso_recording *recording, const char *file,
                     struct iso_frame_list *list, struct iso_fault *fault)
{
    char path[PATH_MAX];
    const int error = iso_path_join(recording->directory, file, path, fault);
    return error ? error : iso__frame_list_read(path, list, fault);
}

/* Finds the intensity frame of the same time for every depth frame. */
static int match_intensity(struct iso_recording *recording, struct iso_fault *fault)
{
    const struct iso_frame_list *depth = &recording->depth, *intensity = &recording->intensity;
    size_t j = 0;
    recording->intensity_of = calloc(depth->n, sizeof *recording->intensity_of);
    if (!recording->intensity_of) {
        return iso_fault_set(fault, -ENOMEM, "%s: out of memory", recording->directory);
    }
    for (size_t i = 0; i < depth->n; i++) {
        const int64_t t_ns = depth->entries[i].t_ns;
        while (j < intensity->n && intensity->entries[j].t_ns < t_ns - MATCH_NS) {
            j++;
        }
        if (j == intensity->n || intensity->entries[j].t_ns > t_ns + MATCH_NS) {
            return iso_fault_set(fault, -EBADMSG, "%s: no infrared or colour frame for %s",
                                 recording->directory, depth->entries[i].file);
        }
        recording->intensity_of[i] = j;
    }
    return 0;
}

static int read_intensity_list(struct iso_recording *recording, struct iso_fault *fault)
{
    recording->intensity_pixels = ISO_PIXEL_GREY8 | ISO_PIXEL_GREY16;
    int error = read_list(recording, "ir.txt", &recording->intensity, fault);
    if (error == -ENOENT) {
        recording->intensity_pixels = ISO_PIXEL_RGB8;
        error = read_list(recording, "rgb.txt", &recording->intensity, fault);
    }
    if (error == -ENOENT) {
        return 0;
    }
    return error ? error : match_intensity(recording, fault);
}

int iso_recording_open(const char *directory, struct iso_recording **out, struct iso_fault *fault)
{
    struct iso_fault reason = {.text = ""};
    struct iso_recording *recording = calloc(1, sizeof *recording);
    int error = -ENOMEM;
    if (!recording || !(recording->directory = strdup(directory))) {
        (void)iso_fault_set(&reason, -ENOMEM, "%s: out of memory", directory);
        goto out;
    }
    error = read_meta(recording, &reason);
    if (!error) {
        error = read_list(recording, "depth.txt", &recording->depth, &reason);
    }
    if (!error) {
        error = read_intensity_list(recording, &reason);
    }
    if (!error) {
        *out = recording;
        recording = NULL;
    }
out:
    iso_recording_close(recording);
    return error ? iso_fault_set_code(fault, reason.code, error, "%s", reason.text) : 0;
}

void iso_recording_close(struct iso_recording *recording)
{
    if (recording) {
        iso__frame_list_done(&recording->depth);
        iso__frame_list_done(&recording->intensity);
        iso_image_done(&recording->depth_image);
        iso_image_done(&recording->intensity_image);
        free(recording->intensity_of);
        free(recording->directory);
        free(recording);
    }
}

/* ---- contents of the recording --------------------------------------------- */

const char *iso__recording_directory(const struct iso_recording *recording)
{
    return recording->directory;
}

const struct iso_recording_meta *iso_recording_meta(const struct iso_recording *recording)
{
    return &recording->meta;
}

size_t iso_recording_frames(const struct iso_recording *recording)
{
    return recording->depth.n;
}

bool iso_recording_has_intensity(const struct iso_recording *recording)
{
    return recording->intensity.n > 0;
}

int64_t iso_recording_t_ns(const struct iso_recording *recording, size_t index)
{
    return recording->depth.entries[index].t_ns;
}

/* ---- reading a frame -------------------------------------------------------- */

int iso_recording_frame_new(const struct iso_recording *recording, struct iso_frame **out)
{
    const struct iso_camera *camera = &recording->meta.camera;
    return iso_frame_new(camera, camera->width_px, camera->height_px,
                         iso_recording_has_intensity(recording), out);
}

static int read_image(const struct iso_recording *recording, const char *file, unsigned pixels,
                      struct iso_image *image, struct iso_fault *fault)
{
    char path[PATH_MAX];
    struct iso_png_expectation expected = {
        .pixels = pixels,
        .width_px = recording->meta.camera.width_px,
        .height_px = recording->meta.camera.height_px,
    };
    int error = iso_path_join(recording->directory, file, path, fault);
    if (!error) {
        error = iso_png_read(path, &expected, image, fault);
    }
    return error == -EINVAL ? -EBADMSG : error;
}

static size_t pixel_count(const struct iso_recording *recording)
{
    const struct iso_camera *camera = &recording->meta.camera;
    return (size_t)camera->width_px * (size_t)camera->height_px;
}

static int read_depth(struct iso_recording *recording, size_t index, float *depth_mm,
                      struct iso_fault *fault)
{
    struct iso_image *image = &recording->depth_image;
    const char *file = recording->depth.entries[index].file;
    const int error = read_image(recording, file, ISO_PIXEL_GREY16, image, fault);
    if (error) {
        return error;
    }
    const uint16_t *counts = image->samples;
    const size_t n = pixel_count(recording);
    for (size_t i = 0; i < n; i++) {
        depth_mm[i] = (float)(counts[i] * recording->meta.unit_mm);
    }
    return 0;
}

static void intensity_from_image(const struct iso_image *image, size_t n, float *intensity)
{
    const uint8_t *bytes = image->samples;
    const uint16_t *words = image->samples;
    for (size_t i = 0; i < n; i++) {
        if (image->pixel == ISO_PIXEL_GREY16) {
            intensity[i] = (float)words[i] / 65535.0F;
        } else if (image->pixel == ISO_PIXEL_GREY8) {
            intensity[i] = (float)bytes[i] / 255.0F;
        } else { /* Rec. ITU-R BT.709 */
            const uint8_t *rgb = &bytes[3 * i];
            intensity[i] = (0.2126F * (float)rgb[0] + 0.7152F * (float)rgb[1] +
                            0.0722F * (float)rgb[2]) /
                           255.0F;
        }
    }
}

static int read_intensity(struct iso_recording *recording, size_t index, float *intensity,
                          struct iso_fault *fault)
{
    struct iso_image *image = &recording->intensity_image;
    const char *file = recording->intensity.entries[recording->intensity_of[index]].file;
    const int error = read_image(recording, file, recording->intensity_pixels, image, fault);
    if (!error) {
        intensity_from_image(image, pixel_count(recording), intensity);
    }
    return error;
}

int iso_recording_read(struct iso_recording *recording, size_t index, struct iso_frame *frame,
                       struct iso_fault *fault)
{
    const struct iso_camera *camera = &recording->meta.camera;
    const bool intensity = iso_recording_has_intensity(recording);
    if (index >= recording->depth.n) {
        return iso_fault_set(fault, -EINVAL, "%s: has no frame %zu", recording->directory, index);
    }
    if (frame->width_px != camera->width_px || frame->height_px != camera->height_px ||
        (frame->intensity != NULL) != intensity) {
        return iso_fault_set(fault, -EINVAL, "%s: frame of another shape", recording->directory);
    }
    int error = read_depth(recording, index, frame->depth_mm, fault);
    if (!error && intensity) {
        error = read_intensity(recording, index, frame->intensity, fault);
    }
    if (!error) {
        frame->camera = *camera;
        frame->crop_x_px = 0;
        frame->crop_y_px = 0;
        frame->t_ns = iso_recording_t_ns(recording, index);
        frame->sequence = index;
    }
    return error;
}
