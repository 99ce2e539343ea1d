/* isotherm-sim calibrate: calibrates two cameras, or one, with pictures of a checkerboard.
 *
 * The command belongs to the simulator because an appliance never calibrates: it only reads the
 * file. The command can also render the pictures with the simulated rig; the tests do this. */
#include <dirent.h>
#include <errno.h>
#include <limits.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "drivers/base/path.h"
#include "drivers/file/png.h"
#include "drivers/stereo/board.h"
#include "drivers/terminal/words.h"
#include "sim/base/make_directory.h"
#include "sim/base/options.h"
#include "sim/base/progress.h"
#include "sim/commands/command.h"
#include "sim/commands/commands.h"
#include "sim/world/stereo/board_picture.h"
#include "sim/world/stereo/lens_calibration.h"
#include "sim/world/stereo/rig.h"

enum { PICTURES_MAX = 1000 };

struct arguments {
    const char *pictures, *render, *out, *camera;
    int columns, rows;
    double square_mm, unit_mm;
    size_t pairs, seed;
};

#define FIELD(name) offsetof(struct arguments, name)

static const struct sim_option options[] = {
    {"pictures", "DIR", "has left/*.png and right/*.png, 8-bit grey, with the same names",
     sim_option_text, FIELD(pictures)},
    {"camera", "NAME",
     "calibrate one camera and give it this name: --pictures has its *.png, grey or RGB",
     sim_option_text, FIELD(camera)},
    {"unit", "MM", "with --camera: length of one unit of its depths (1)", sim_option_number,
     FIELD(unit_mm)},
    {"out", "FILE", "the calibration to write", sim_option_text, FIELD(out)},
    {"columns", "N", "inner corners in each row of the board (9)", sim_option_int, FIELD(columns)},
    {"rows", "N", "inner corners in each column of the board (6)", sim_option_int, FIELD(rows)},
    {"square", "MM", "side of a square, measured on the print (20)", sim_option_number,
     FIELD(square_mm)},
    {"render", "DIR", "do not calibrate, but write such pictures, rendered with simulated cameras",
     sim_option_text, FIELD(render)},
    {"pairs", "N", "with --render: number of pairs, or of pictures of one camera (20)",
     sim_option_count, FIELD(pairs)},
    {"seed", "S", "with --render: seed of the random poses and noise (1)", sim_option_count,
     FIELD(seed)},
};

static const char *const eye_names[ISO_EYES] = {"left", "right"};

static struct iso_board board_of(const struct arguments *a)
{
    return (struct iso_board){a->columns, a->rows, a->square_mm};
}

/* ---- rendering -------------------------------------------------------------- */

static int write_picture(const char *directory, int eye, size_t number,
                         const struct iso_image *image, struct iso_fault *fault)
{
    char path[PATH_MAX];
    const int length = snprintf(path, sizeof path, "%s/%s/%03zu.png", directory, eye_names[eye],
                                number);
    if (length < 0 || (size_t)length >= sizeof path) {
        return iso_fault_set(fault, -ENAMETOOLONG, "%s: path too long", directory);
    }
    return iso_png_write(path, image, 1, fault);
}

static int make_subdirectory(const char *parent, const char *name, struct iso_fault *fault)
{
    char path[PATH_MAX];
    const int error = iso_path_join(parent, name, path, fault);
    if (error) {
        return error;
    }
    return sim_make_directory(path, fault);
}

/* Renders one pair of pictures of the board in a random pose in front of the rig. */
static int render_pair(const struct arguments *a, const struct sim_stereo_rig *rig,
                       struct sim_lens *const lenses[ISO_EYES], size_t number,
                       struct iso_image *image, struct iso_fault *fault)
{
    const struct iso_board board = board_of(a);
    struct sim_random random = sim_random_seeded(a->seed, sim_random_hash("board"), number);
    struct iso_rigid pose[ISO_EYES];
    int error = 0;
    pose[ISO_EYE_LEFT] = sim_board_pose(&rig->built, &board, &random);
    pose[ISO_EYE_RIGHT] = iso_rigid_mul(&rig->built.right_from_left, &pose[ISO_EYE_LEFT]);
    for (int eye = 0; !error && eye < ISO_EYES; eye++) {
        sim_board_picture(&board, lenses[eye], &pose[eye], 2.0, &random, image->samples);
        error = write_picture(a->render, eye, number, image, fault);
    }
    return error;
}

static int prepare_rendering(const struct sim_stereo_rig *rig, struct iso_image *image,
                             struct sim_lens *lenses[ISO_EYES], struct iso_fault *fault)
{
    const struct iso_camera *camera = rig->built.camera;
    *image = (struct iso_image){
        .width_px = camera->width_px, .height_px = camera->height_px, .pixel = ISO_PIXEL_GREY8};
    image->samples = malloc((size_t)camera->width_px * (size_t)camera->height_px);
    bool good = image->samples != NULL;
    for (int eye = 0; good && eye < ISO_EYES; eye++) {
        good = sim_lens_new(&camera[eye], &lenses[eye]) == 0;
    }
    return good ? 0 : iso_fault_set(fault, -ENOMEM, "out of memory");
}

static int render_pairs(const struct arguments *a, struct iso_fault *fault)
{
    const struct sim_stereo_rig rig = sim_stereo_rig(0.0);
    struct iso_image image = {0};
    struct sim_lens *lenses[ISO_EYES] = {NULL};
    int error = prepare_rendering(&rig, &image, lenses, fault);
    if (!error) {
        error = sim_make_directory(a->render, fault);
    }
    for (int eye = 0; !error && eye < ISO_EYES; eye++) {
        error = make_subdirectory(a->render, eye_names[eye], fault);
    }
    const bool shown = sim_progress_begin("rendering pictures", a->pairs);
    for (size_t i = 0; !error && i < a->pairs; i++) {
        error = render_pair(a, &rig, lenses, i, &image, fault);
        sim_progress_step(1);
    }
    sim_progress_end(shown);
    free(image.samples);
    sim_lens_free(lenses[ISO_EYE_LEFT]);
    sim_lens_free(lenses[ISO_EYE_RIGHT]);
    if (!error) {
        printf("%zu %s of pictures in %s\n", a->pairs, iso_plural(a->pairs, "pair", "pairs"),
               a->render);
    }
    return error;
}

/* ---- calibrating ------------------------------------------------------------ */

static int is_picture(const struct dirent *entry)
{
    const size_t length = strlen(entry->d_name);
    return length > 4 && strcmp(entry->d_name + length - 4, ".png") == 0;
}

static int read_picture(const char *directory, int eye, const char *name, struct iso_image *image,
                        struct iso_fault *fault)
{
    char folder[PATH_MAX], path[PATH_MAX];
    const struct iso_png_expectation grey = {ISO_PIXEL_GREY8, image->width_px, image->height_px};
    int error = iso_path_join(directory, eye_names[eye], folder, fault);
    if (!error) {
        error = iso_path_join(folder, name, path, fault);
    }
    if (error) {
        return error;
    }
    return iso_png_read(path, &grey, image, fault);
}

/* Reads one pair of pictures and adds it. The first pair determines the size of all others. A pair
 * that does not show the whole board is reported and skipped. */
static int add_pair(const struct arguments *a, const char *name, struct iso_image images[ISO_EYES],
                    struct iso_board_views **views, struct iso_fault *fault)
{
    const struct iso_board board = board_of(a);
    int error = read_picture(a->pictures, ISO_EYE_LEFT, name, &images[ISO_EYE_LEFT], fault);
    if (!error) {
        images[ISO_EYE_RIGHT].width_px = images[ISO_EYE_LEFT].width_px;
        images[ISO_EYE_RIGHT].height_px = images[ISO_EYE_LEFT].height_px;
        error = read_picture(a->pictures, ISO_EYE_RIGHT, name, &images[ISO_EYE_RIGHT], fault);
    }
    if (!error && !*views) {
        error = iso_board_views_new(&board, images[0].width_px, images[0].height_px, views, fault);
    }
    if (error) {
        return error;
    }
    error = iso_board_views_add(*views, images[0].samples, images[1].samples);
    if (error == -ENOENT) {
        sim_progress_pause();
        printf("%s: skipped, because the whole board is not visible in both pictures\n", name);
        (void)fflush(stdout);
        sim_progress_resume();
        return 0;
    }
    return error ? iso_fault_set(fault, error, "%s: %s", name, strerror(-error)) : 0;
}

static int read_views(const struct arguments *a, struct iso_board_views **views,
                      struct iso_fault *fault)
{
    char left[PATH_MAX];
    struct dirent **entries = NULL;
    struct iso_image images[ISO_EYES] = {{0}};
    int error = iso_path_join(a->pictures, eye_names[ISO_EYE_LEFT], left, fault);
    if (error) {
        return error;
    }
    const int n = scandir(left, &entries, is_picture, alphasort);
    if (n < 0) {
        return iso_fault_set(fault, -errno, "%s: %m", left);
    }
    if (n == 0 || n > PICTURES_MAX) {
        error = iso_fault_set(fault, -ENODATA, "%s: %d pictures, not 1 to %d", left, n,
                              PICTURES_MAX);
    }
    const bool shown = sim_progress_begin("looking for the board in pictures", (uint64_t)n);
    for (int i = 0; !error && i < n; i++) {
        error = add_pair(a, entries[i]->d_name, images, views, fault);
        sim_progress_step(1);
    }
    sim_progress_end(shown);
    for (int i = 0; i < n; i++) {
        free(entries[i]);
    }
    free(entries);
    iso_image_done(&images[ISO_EYE_LEFT]);
    iso_image_done(&images[ISO_EYE_RIGHT]);
    return error;
}

static int calibrate_single(const struct arguments *a, struct iso_fault *fault)
{
    const struct sim_lens_calibration_options single = {board_of(a), a->pictures, a->camera,
                                                        a->unit_mm, a->out};
    return sim_lens_calibrate(&single, fault);
}

static int render_single(const struct arguments *a, struct iso_fault *fault)
{
    const struct iso_board board = board_of(a);
    const int error = sim_lens_pictures(&board, a->pairs, a->seed, a->render, fault);
    if (!error) {
        printf("%zu pictures in %s\n", a->pairs, a->render);
    }
    return error;
}

static void print_calibration(const struct iso_stereo_calibration *c)
{
    printf("%d pairs, %.3f px between corners and model (root mean square)\n", c->pairs, c->rms_px);
    for (int eye = 0; eye < ISO_EYES; eye++) {
        const struct iso_camera *k = &c->camera[eye];
        printf("%-5s  focal length %.2f %.2f px, principal point %.2f %.2f px, "
               "distortion %.4f %.4f %.5f %.5f\n",
               eye_names[eye], k->fx_px, k->fy_px, k->cx_px, k->cy_px, k->k1, k->k2, k->p1, k->p2);
    }
    printf("baseline %.3f mm\n", iso_stereo_baseline_mm(c));
}

static void count_solution(void *context)
{
    (void)context;
    sim_progress_step(1);
}

static int calibrate_pair(const struct arguments *a, struct iso_fault *fault)
{
    struct iso_board_views *views = NULL;
    struct iso_stereo_calibration calibration;
    int error = read_views(a, &views, fault);
    if (!error) {
        const bool shown = sim_progress_begin("solving for the cameras", ISO_BOARD_SOLUTIONS);
        error = iso_board_calibrate(views, count_solution, NULL, &calibration, fault);
        sim_progress_end(shown);
    }
    if (!error) {
        error = iso_stereo_calibration_write(a->out, &calibration, fault);
    }
    if (!error) {
        print_calibration(&calibration);
    }
    iso_board_views_free(views);
    return error;
}

static int carry_out(const struct arguments *a, struct iso_fault *fault)
{
    if (a->render) {
        return a->camera ? render_single(a, fault) : render_pairs(a, fault);
    }
    return a->camera ? calibrate_single(a, fault) : calibrate_pair(a, fault);
}

int sim_cmd_calibrate(int argc, char **argv)
{
    struct arguments arguments = {
        .columns = 9, .rows = 6, .square_mm = 20.0, .unit_mm = 1.0, .pairs = 20, .seed = 1};
    const struct sim_option_set set = {options, sizeof options / sizeof *options, &arguments};
    struct iso_fault fault = {.text = ""};
    switch (sim_options_parse(argc, argv, &set, 1, &fault)) {
    case SIM_OPTIONS_HELP:
        puts("Usage: isotherm-sim calibrate --pictures DIR --out FILE [OPTION...]\n"
             "       isotherm-sim calibrate --camera NAME --pictures DIR --out FILE [OPTION...]\n"
             "       isotherm-sim calibrate --render DIR [OPTION...]\n\n"
             "Calibrates two cameras with about 20 pairs of pictures of a checkerboard. Both\n"
             "cameras must take a pair at the same moment. Turn the board and move it all over\n"
             "the picture from pair to pair.\n"
             "With --camera it calibrates one camera. The pictures are then from the stream that\n"
             "its depths are aligned to; the file is for [sensor] camera of isotherm.conf(5).\n");
        sim_options_help(&set, 1, stdout);
        return SIM_EXIT_OK;
    case SIM_OPTIONS_REFUSED:
        fprintf(stderr, "isotherm-sim calibrate: %s\n", fault.text);
        return SIM_EXIT_USAGE;
    case SIM_OPTIONS_READ:
        break;
    }
    const bool usable = arguments.render ? !arguments.pictures && arguments.pairs <= PICTURES_MAX
                                         : arguments.pictures && arguments.out;
    if (!usable) {
        fputs("isotherm-sim calibrate: --pictures and --out are needed, or --render (at most 1000 "
              "pairs)\n",
              stderr);
        return SIM_EXIT_USAGE;
    }
    const int error = carry_out(&arguments, &fault);
    if (error) {
        fprintf(stderr, "isotherm-sim calibrate: %s\n", fault.text);
        return sim_command_exit_code(error);
    }
    return SIM_EXIT_OK;
}
