#include "tests/vm/usb/eye_pair.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sim/base/random.h"

enum {
    FINE = 4,        /* samples of the pattern per pixel, along a row */
    SPECK_PX = 2,    /* size of the pattern's specks */
    NOISE_LEVELS = 4 /* the noise of a picture is uniform between -4 and 4 grey levels */
};

/* Neighbours whose depths differ by more belong to different surfaces: mm per mm of distance. */
static const float step = 0.03f;

struct eye_pair {
    struct iso_camera camera;
    uint8_t *pattern; /* [height_px][FINE * width_px]: as the left camera sees it. It is the same on
                         every surface, because the projector is in the place of that camera */
    float *nearest_mm; /* [width_px]: depths drawn so far in a row of the right picture */
};

/* ---- the pattern ------------------------------------------------------------- */

static double smooth(double t)
{
    return t * t * (3.0 - 2.0 * t);
}

/* Brightness, 0..1, of the speck at a crossing of the grid. */
static double speck(int column, int row)
{
    struct sim_random random = sim_random_seeded((uint64_t)(uint32_t)column,
                                                 (uint64_t)(uint32_t)row, 0);
    return sim_random_unit(&random);
}

/* Draws random specks, one at each crossing of a grid, with smooth transitions between them. */
static void draw_pattern(struct eye_pair *pair, const double *specks, int columns)
{
    const int wide = FINE * pair->camera.width_px;
    for (int row = 0; row < pair->camera.height_px; row++) {
        const double *above = specks + (ptrdiff_t)(row / SPECK_PX) * columns;
        const double v = smooth((double)(row % SPECK_PX) / SPECK_PX);
        for (int i = 0; i < wide; i++) {
            const int at = i / (FINE * SPECK_PX);
            const double u = smooth((double)(i % (FINE * SPECK_PX)) / (FINE * SPECK_PX));
            const double top = (1.0 - u) * above[at] + u * above[at + 1];
            const double low = (1.0 - u) * above[at + columns] + u * above[at + 1 + columns];
            pair->pattern[(ptrdiff_t)row * wide + i] = (uint8_t)(20.0 + 215.0 * ((1.0 - v) * top +
                                                                                 v * low));
        }
    }
}

static int make_pattern(struct eye_pair *pair)
{
    const int columns = pair->camera.width_px / SPECK_PX + 2;
    const int rows = pair->camera.height_px / SPECK_PX + 2;
    double *specks = calloc((size_t)columns * (size_t)rows, sizeof *specks);
    if (!specks) {
        return -ENOMEM;
    }
    for (int i = 0; i < columns * rows; i++) {
        specks[i] = speck(i % columns, i / columns);
    }
    draw_pattern(pair, specks, columns);
    free(specks);
    return 0;
}

int eye_pair_new(const struct iso_camera *camera, struct eye_pair **out)
{
    struct eye_pair *pair = calloc(1, sizeof *pair);
    if (!pair) {
        return -ENOMEM;
    }
    pair->camera = *camera;
    pair->pattern = malloc((size_t)FINE * (size_t)camera->width_px * (size_t)camera->height_px);
    pair->nearest_mm = calloc((size_t)camera->width_px, sizeof *pair->nearest_mm);
    if (!pair->pattern || !pair->nearest_mm || make_pattern(pair)) {
        eye_pair_free(pair);
        return -ENOMEM;
    }
    *out = pair;
    return 0;
}

void eye_pair_free(struct eye_pair *pair)
{
    if (pair) {
        free(pair->pattern);
        free(pair->nearest_mm);
        free(pair);
    }
}

struct iso_stereo_calibration eye_pair_calibration(const struct eye_pair *pair)
{
    return (struct iso_stereo_calibration){
        .camera = {pair->camera, pair->camera},
        .right_from_left = {iso_mat3_identity(), {-(double)EYE_PAIR_BASELINE_MM, 0.0, 0.0}}};
}

/* ---- pictures ---------------------------------------------------------------- */

/* The piece of surface between two neighbouring pixels of a row. The right camera sees it between
 * from_px and to_px. */
struct piece {
    float from_px, to_px, from_mm, to_mm;
};

/* Draws a piece into a row of the right picture, where no nearer surface hides it. */
static void see_piece(struct eye_pair *pair, const struct piece *piece, const uint8_t *pattern,
                      uint8_t *right)
{
    const int last = (int)floorf(piece->to_px);
    for (int x = (int)ceilf(piece->from_px); x <= last; x++) {
        const float t = (float)((float)x - piece->from_px) / (piece->to_px - piece->from_px);
        const float z_mm = piece->from_mm + t * (piece->to_mm - piece->from_mm);
        if (x >= 0 && x < pair->camera.width_px && z_mm < pair->nearest_mm[x]) {
            pair->nearest_mm[x] = z_mm;
            right[x] = pattern[(int)lrintf(t * FINE)];
        }
    }
}

static void look_at_row(struct eye_pair *pair, const float *depth_mm, const uint8_t *pattern,
                        uint8_t *left, uint8_t *right)
{
    const int width = pair->camera.width_px;
    const float fb = (float)(pair->camera.fx_px * EYE_PAIR_BASELINE_MM);
    for (int x = 0; x < width; x++) {
        pair->nearest_mm[x] = INFINITY;
    }
    for (int x = 0; x < width; x++) {
        left[x] = depth_mm[x] > 0.0f ? pattern[FINE * x] : 0;
    }
    for (int x = 0; x + 1 < width; x++) {
        const float a = depth_mm[x], b = depth_mm[x + 1];
        if (a > 0.0f && b > 0.0f && fabsf(a - b) < step * a) {
            const struct piece piece = {(float)x - fb / a, (float)(x + 1) - fb / b, a, b};
            see_piece(pair, &piece, pattern + (ptrdiff_t)FINE * x, right);
        }
    }
}

static void add_noise(uint64_t key, uint64_t eye, size_t n, uint8_t *picture)
{
    struct sim_random random = sim_random_seeded(key, eye, 0);
    uint64_t bits = 0;
    for (size_t i = 0; i < n; i++) {
        bits = i % 8 == 0 ? sim_random_u64(&random) : bits >> 8;
        const int level = picture[i] + (int)(bits & 0xff) % (2 * NOISE_LEVELS + 1) - NOISE_LEVELS;
        const int light = level > 0 ? level : 0;
        picture[i] = (uint8_t)(light < 255 ? light : 255);
    }
}

void eye_pair_look(struct eye_pair *pair, const struct iso_frame *frame, uint64_t noise_key,
                   uint8_t *left, uint8_t *right)
{
    const size_t width = (size_t)pair->camera.width_px, height = (size_t)pair->camera.height_px;
    memset(right, 0, width * height);
    for (size_t row = 0; row < height; row++) {
        look_at_row(pair, frame->depth_mm + row * width, pair->pattern + row * width * FINE,
                    left + row * width, right + row * width);
    }
    add_noise(noise_key, 0, width * height, left);
    add_noise(noise_key, 1, width * height, right);
}
