/* Frames of a broken or hostile depth camera: a coarsely sampled rendered face, on which the input
 * draws. The extraction must return an outcome for every frame that passes its check. */
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "drivers/file/data_file.h"
#include "drivers/recording/recording.h"
#include "isotherm/extract.h"
#include "tests/fuzz/fuzz.h"

enum { STEP = 6 }; /* every sixth pixel of the stored frame is taken, in both directions */

static struct iso_extractor *extractor;
static struct iso_frame *face, *frame;

static void load_face(void)
{
    struct iso_fault fault = {.text = ""};
    struct iso_recording *recording = NULL;
    struct iso_frame *stored = NULL;
    int error = iso_recording_open(ISOTHERM_SOURCE_DIR "/sim/stored/p01-v1", &recording, &fault);
    if (!error) {
        error = iso_recording_frame_new(recording, &stored);
    }
    if (!error) {
        error = iso_recording_read(recording, 0, stored, &fault);
    }
    fuzz_check(error == 0, fault.text);
    struct iso_camera camera = stored->camera;
    camera.width_px = stored->width_px / STEP;
    camera.height_px = stored->height_px / STEP;
    camera.fx_px /= STEP;
    camera.fy_px /= STEP;
    camera.cx_px = (stored->camera.cx_px - stored->crop_x_px) / STEP;
    camera.cy_px = (stored->camera.cy_px - stored->crop_y_px) / STEP;
    fuzz_check(iso_frame_new(&camera, camera.width_px, camera.height_px, false, &face) == 0 &&
                   iso_frame_new(&camera, camera.width_px, camera.height_px, false, &frame) == 0,
               "room for a frame");
    for (int row = 0; row < face->height_px; row++) {
        for (int column = 0; column < face->width_px; column++) {
            face->depth_mm[row * face->width_px + column] = iso_frame_depth_at(
                stored, STEP * column, STEP * row);
        }
    }
    iso_frame_free(stored);
    iso_recording_close(recording);
}

static void load_extractor(void)
{
    struct iso_fault fault = {.text = ""};
    struct iso_extract_options options = iso_extract_options_default();
    struct iso_head_model *model = NULL;
    struct iso_fault what = {.text = ""};
    void *bytes = NULL;
    size_t size = 0;
    fuzz_check(iso_data_file_read(ISOTHERM_SOURCE_DIR "/core/data/head.model", 1 << 26, &bytes,
                                  &size, &fault) == 0,
               fault.text);
    fuzz_check(iso_head_model_parse(bytes, size, &model, &what) == 0, "a head model");
    free(bytes);
    options.track = true;
    fuzz_check(iso_extractor_new(model, &options, &extractor) == 0, "an extractor");
}

static float depth_of(const uint8_t *bytes)
{
    float depth;
    memcpy(&depth, bytes, sizeof depth);
    return depth;
}

/* A stroke is twelve bytes: the operation, its place (left, top, width, height), and parameters. */
static void draw(const uint8_t stroke[12])
{
    const int left = stroke[1] * frame->width_px / 256, top = stroke[2] * frame->height_px / 256;
    const int width = 1 + stroke[3] * frame->width_px / 256;
    const int height = 1 + stroke[4] * frame->height_px / 256;
    uint32_t noise = stroke[5] | 1u;
    for (int row = top; row < top + height && row < frame->height_px; row++) {
        for (int column = left; column < left + width && column < frame->width_px; column++) {
            float *depth = &frame->depth_mm[row * frame->width_px + column];
            noise = noise * 1664525u + 1013904223u;
            switch (stroke[0] % 7) {
            case 0:
                *depth = 0.0f;
                break;
            case 1:
                *depth = depth_of(stroke + 8); /* any float at all */
                break;
            case 2:
                *depth = fmaxf(*depth + 8.0f * (float)(stroke[6] - 128), 0.0f);
                break;
            case 3:
                *depth *= (float)stroke[6] / 64.0f;
                break;
            case 4: /* holes */
                *depth = noise >> 24 < stroke[6] ? 0.0f : *depth;
                break;
            case 5: /* noise */
                *depth += *depth > 0.0f ? (float)(noise >> 24) * (float)stroke[6] / 256.0f : 0.0f;
                break;
            default: /* a slope */
                *depth = 300.0f + 4.0f * (float)stroke[6] +
                         (float)((stroke[8] - 128) * (row - top) +
                                 (stroke[9] - 128) * (column - left)) *
                             0.05f;
            }
        }
    }
}

/* Gives the frame a camera with one of several focal lengths. */
static void choose_camera(uint8_t choice)
{
    const double factors[] = {1.0, 1.0, 0.5, 2.0, 1e-6, 1e6, 1.0, 1.0};
    frame->camera = face->camera;
    frame->camera.fx_px *= factors[choice & 7];
    frame->camera.fy_px *= factors[choice >> 3 & 7];
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static struct iso_extraction extraction;
    if (!extractor) {
        load_face();
        load_extractor();
    }
    const size_t n = (size_t)face->width_px * (size_t)face->height_px;
    iso_extractor_forget(extractor);
    frame->sequence = 0;
    while (size >= 2 && frame->sequence < 2) { /* the second face is searched near the first one */
        const size_t n_strokes = data[1] % 8;
        const bool whole = data[1] >= 240; /* the heat takes most of the time */
        memcpy(frame->depth_mm, face->depth_mm, n * sizeof *face->depth_mm);
        frame->sequence++;
        frame->t_ns = (int64_t)frame->sequence * 33000000;
        choose_camera(data[0]);
        data += 2;
        size -= 2;
        for (size_t i = 0; i < n_strokes && size >= 12; i++, data += 12, size -= 12) {
            draw(data);
        }
        struct iso_fault flaw = {.text = ""};
        const int checked = iso_frame_check(frame, &flaw);
        const int error = whole ? iso_extractor_run(extractor, frame, &extraction)
                                : iso_extractor_locate(extractor, frame, &extraction);
        fuzz_check((checked == 0) == (error != -EINVAL),
                   "a frame is refused exactly if it fails the check");
        fuzz_check(error || (unsigned)extraction.outcome < ISO_CAPTURES, "the outcome has a name");
        fuzz_check(!whole || error || extraction.outcome != ISO_CAPTURE_OK ||
                       (isfinite(extraction.residual_mm) && extraction.tmpl.n_points > 0 &&
                        isfinite(extraction.tmpl.points_mm[0][0][0][0])),
                   "the template has only finite numbers");
    }
    return 0;
}
