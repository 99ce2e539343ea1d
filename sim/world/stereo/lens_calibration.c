#include "sim/world/stereo/lens_calibration.h"

#include <dirent.h>
#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "drivers/base/path.h"
#include "drivers/file/png.h"
#include "drivers/recording/recording_ini.h"
#include "sim/base/make_directory.h"
#include "sim/world/stereo/board_picture.h"
#include "sim/world/stereo/rig.h"

enum { PICTURES_MAX = 1000 };

/* ---- reading ---- */

static int is_picture(const struct dirent *entry)
{
    const size_t length = strlen(entry->d_name);
    return length > 4 && strcmp(entry->d_name + length - 4, ".png") == 0;
}

/* Converts RGB samples to grey (Rec. 709 luma) in place. The grey sample of a pixel replaces only
 * colour samples that are no longer needed. */
static void make_grey(struct iso_image *image)
{
    uint8_t *samples = image->samples;
    const size_t n = (size_t)image->width_px * (size_t)image->height_px;
    for (size_t i = 0; image->pixel == ISO_PIXEL_RGB8 && i < n; i++) {
        const double luma = 0.2126 * samples[3 * i] + 0.7152 * samples[3 * i + 1] +
                            0.0722 * samples[3 * i + 2];
        samples[i] = (uint8_t)(luma + 0.5);
    }
}

/* Reads a picture and adds it. The first picture determines the size of all. A picture that does
 * not show the whole board is reported and skipped. */
static int add_picture(const struct sim_lens_calibration_options *options, const char *name,
                       struct iso_image *image, struct iso_board_views **views,
                       struct iso_fault *fault)
{
    const struct iso_png_expectation grey_or_colour = {ISO_PIXEL_GREY8 | ISO_PIXEL_RGB8,
                                                       *views ? image->width_px : 0,
                                                       *views ? image->height_px : 0};
    char path[PATH_MAX];
    int error = iso_path_join(options->pictures, name, path, fault);
    if (!error) {
        error = iso_png_read(path, &grey_or_colour, image, fault);
    }
    if (!error && !*views) {
        error = iso_board_views_new(&options->board, image->width_px, image->height_px, views,
                                    fault);
    }
    if (error) {
        return error;
    }
    make_grey(image);
    error = iso_board_views_add_single(*views, image->samples);
    if (error == -ENOENT) {
        printf("%s: the whole board is not visible\n", name);
        return 0;
    }
    return error ? iso_fault_set(fault, error, "%s: %s", path, strerror(-error)) : 0;
}

static int gather(const struct sim_lens_calibration_options *options,
                  struct iso_board_views **views, struct iso_fault *fault)
{
    struct dirent **entries = NULL;
    struct iso_image image = {.width_px = 0};
    int error = 0;
    const int n = scandir(options->pictures, &entries, is_picture, alphasort);
    if (n < 0) {
        return iso_fault_set(fault, -errno, "%s: %m", options->pictures);
    }
    if (n == 0 || n > PICTURES_MAX) {
        error = iso_fault_set(fault, -ENODATA, "%s: %d pictures, not 1 to %d", options->pictures, n,
                              PICTURES_MAX);
    }
    for (int i = 0; !error && i < n; i++) {
        error = add_picture(options, entries[i]->d_name, &image, views, fault);
    }
    for (int i = 0; i < n; i++) {
        free(entries[i]);
    }
    free(entries);
    iso_image_done(&image);
    return error;
}

/* ---- writing ---- */

static int write_lens(const char *path, const struct iso_recording_meta *meta,
                      const struct iso_board_lens *lens, struct iso_fault *fault)
{
    FILE *file = fopen(path, "we");
    if (!file) {
        return iso_fault_set(fault, -errno, "%s: %m", path);
    }
    fprintf(file,
            "# Measured by isotherm-sim calibrate on %d pictures of a checkerboard;\n"
            "# %.3f px between corners and model (root mean square).\n",
            lens->views, lens->rms_px);
    int error = sim_recording_ini_print(file, meta);
    if (fclose(file) != 0 && !error) {
        error = -errno;
    }
    if (error) {
        (void)unlink(path);
        return iso_fault_set(fault, error, "%s: %s", path, strerror(-error));
    }
    return 0;
}

static void print(const struct iso_board_lens *lens)
{
    const struct iso_camera *k = &lens->camera;
    printf("%d pictures, %.3f px between corners and model (root mean square)\n"
           "focal length %.2f %.2f px, principal point %.2f %.2f px, "
           "distortion %.4f %.4f %.5f %.5f\n",
           lens->views, lens->rms_px, k->fx_px, k->fy_px, k->cx_px, k->cy_px, k->k1, k->k2, k->p1,
           k->p2);
}

int sim_lens_calibrate(const struct sim_lens_calibration_options *options, struct iso_fault *fault)
{
    struct iso_recording_meta meta = {.unit_mm = options->unit_mm};
    struct iso_board_views *views = NULL;
    struct iso_board_lens lens;
    struct iso_fault why;
    (void)snprintf(meta.sensor, sizeof meta.sensor, "%s", options->sensor);
    int error = gather(options, &views, fault);
    if (!error) {
        error = iso_board_calibrate_single(views, &lens, fault);
    }
    if (!error) {
        meta.camera = lens.camera;
        error = iso_recording_meta_check(&meta, &why)
                    ? iso_fault_set_code(fault, why.code, -EINVAL, "%s: %s", options->sensor,
                                         why.text)
                    : 0;
    }
    if (!error) {
        error = write_lens(options->out, &meta, &lens, fault);
    }
    if (!error) {
        print(&lens);
    }
    iso_board_views_free(views);
    return error;
}

/* ---- pictures of a board ---- */

int sim_lens_pictures(const struct iso_board *board, size_t n, uint64_t seed, const char *directory,
                      struct iso_fault *fault)
{
    const struct sim_stereo_rig rig = sim_stereo_rig(0.0);
    const struct iso_camera *camera = &rig.built.camera[ISO_EYE_LEFT];
    struct iso_image image = {
        .width_px = camera->width_px, .height_px = camera->height_px, .pixel = ISO_PIXEL_GREY8};
    struct sim_lens *lens = NULL;
    int error = sim_make_directory(directory, fault);
    if (error) {
        return error;
    }
    image.samples = malloc((size_t)image.width_px * (size_t)image.height_px);
    if (!image.samples || sim_lens_new(camera, &lens)) {
        error = iso_fault_set(fault, -ENOMEM, "out of memory");
    }
    for (size_t i = 0; !error && i < n; i++) {
        char name[32], path[PATH_MAX];
        struct sim_random random = sim_random_seeded(seed, sim_random_hash("lens"), i);
        const struct iso_rigid pose = sim_board_pose(&rig.built, board, &random);
        (void)snprintf(name, sizeof name, "%03zu.png", i);
        sim_board_picture(board, lens, &pose, 2.0, &random, image.samples);
        error = iso_path_join(directory, name, path, fault);
        if (!error) {
            error = iso_png_write(path, &image, 1, fault);
        }
    }
    free(image.samples);
    sim_lens_free(lens);
    return error;
}
