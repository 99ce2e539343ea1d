#include "drivers/vision/face_chip.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    SIDE = ISO_FACE_CHIP_SIDE,
    CELLS = ISO_FACE_CHIP_CELLS,
    MIDDLE = ISO_FACE_CHIP_MIDDLE,
    FILL_STEPS = 10, /* the surface is continued by so many cells into holes and the hidden side */
    WINDOW_MAX = 8,
};

static const double pitch_mm = ISO_FACE_CHIP_PITCH_MM;
static const double cell_mm = ISO_FACE_CHIP_PITCH_MM * ISO_FACE_CHIP_CELL;

/* The range of the surface of the face behind the nose tip and in front of it. The points of a cell
 * that are averaged lie within a layer of this depth. */
static const double behind_mm = 140.0, before_mm = 60.0, layer_mm = 15.0;

/* The grey level of the face's middle. A spot that is twice as bright does not saturate. */
static const double middle_grey = 110.0;
static const double saturated_level = 0.98, measured_min = 0.25;

struct iso_vec3 iso_face_chip_place(double column_px, double row_px)
{
    const double middle = 0.5 * (SIDE - 1);
    return iso_vec3((column_px - middle) * pitch_mm,
                    ISO_FACE_CHIP_Y_MM - (row_px - middle) * pitch_mm, 0.0);
}

/* ---- the surface ---- */

/* Adds a measured point. If a cell has several layers, the foremost one counts. */
static void add_point(struct iso_face_chip *chip, struct iso_vec3 p)
{
    const double column = floor(p.x / cell_mm + 0.5 * CELLS);
    const double row = floor((ISO_FACE_CHIP_Y_MM - p.y) / cell_mm + 0.5 * CELLS);
    if (!(column >= 0.0 && column < CELLS && row >= 0.0 && row < CELLS) || p.z < -behind_mm ||
        p.z > before_mm) {
        return;
    }
    const size_t i = (size_t)row * CELLS + (size_t)column;
    const double old = (double)chip->surface_mm[i];
    if (chip->weight[i] == 0 || p.z > old + layer_mm) {
        chip->surface_mm[i] = (float)p.z;
        chip->weight[i] = 1;
    } else if (p.z > old - layer_mm && chip->weight[i] < UINT16_MAX) {
        chip->weight[i]++;
        chip->surface_mm[i] = (float)(old + (p.z - old) / chip->weight[i]);
    }
}

struct window {
    int left, top, right, bottom; /* right and bottom are outside the window */
};

static int clamp_value(double value, int last)
{
    if (value < 0.0) {
        return 0;
    }
    return value > last ? last : (int)value;
}

/* The part of the frame that a ball around the nose can cover. */
static struct window window_about(const struct iso_frame *frame, struct iso_vec3 nose_mm)
{
    const double radius_mm = 0.75 * SIDE * pitch_mm;
    double u = 0.0, v = 0.0;
    if (!iso_camera_project(&frame->camera, nose_mm, &u, &v)) {
        return (struct window){0, 0, 0, 0};
    }
    const double near_mm = fmax(nose_mm.z - before_mm, 1.0);
    const double radius_px = radius_mm / iso_camera_pixel_mm(&frame->camera, near_mm);
    u -= frame->crop_x_px;
    v -= frame->crop_y_px;
    return (struct window){
        .left = clamp_value(u - radius_px, frame->width_px),
        .top = clamp_value(v - radius_px, frame->height_px),
        .right = clamp_value(u + radius_px + 1.0, frame->width_px),
        .bottom = clamp_value(v + radius_px + 1.0, frame->height_px),
    };
}

static void gather_surface(struct iso_face_chip *chip, const struct iso_frame *frame,
                           const struct iso_rigid *camera_from_face)
{
    const struct iso_rigid face_from_camera = iso_rigid_inverse(camera_from_face);
    const struct window w = window_about(frame, camera_from_face->translation_mm);
    memset(chip->weight, 0, sizeof chip->weight);
    for (int row = w.top; row < w.bottom; row++) {
        for (int column = w.left; column < w.right; column++) {
            if (iso_frame_depth_at(frame, column, row) > 0.0F) {
                add_point(chip, iso_rigid_apply(&face_from_camera,
                                                iso_frame_point_at(frame, column, row)));
            }
        }
    }
}

/* The mean of a cell's neighbours that were filled before step `before`, with weight 2 for edges
 * and 1 for corners. Returns the sum of the weights; 0 means that there is no such neighbour. */
static int mean_of_neighbours(const struct iso_face_chip *chip, const uint8_t *step, int column,
                              int row, int before, double *mean)
{
    double sum = 0.0;
    int weight = 0;
    for (int dr = -1; dr <= 1; dr++) {
        for (int dc = -1; dc <= 1; dc++) {
            const int c = column + dc, r = row + dr;
            if ((dc == 0 && dr == 0) || c < 0 || c >= CELLS || r < 0 || r >= CELLS ||
                step[r * CELLS + c] >= before) {
                continue;
            }
            const int w = dc == 0 || dr == 0 ? 2 : 1;
            sum += w * (double)chip->surface_mm[r * CELLS + c];
            weight += w;
        }
    }
    *mean = weight > 0 ? sum / weight : 0.0;
    return weight;
}

/* Continues the surface into holes, ring by ring: the value of a cell filled in step k comes from
 * cells of earlier steps. */
static void fill_surface(struct iso_face_chip *chip, uint8_t step[CELLS * CELLS])
{
    for (int i = 0; i < CELLS * CELLS; i++) {
        step[i] = chip->weight[i] > 0 ? 0 : FILL_STEPS + 1;
    }
    for (int k = 1; k <= FILL_STEPS; k++) {
        for (int i = 0; i < CELLS * CELLS; i++) {
            double mean;
            if (step[i] > k && mean_of_neighbours(chip, step, i % CELLS, i / CELLS, k, &mean) > 0) {
                chip->surface_mm[i] = (float)mean;
                step[i] = (uint8_t)k;
            }
        }
    }
}

/* Replaces half of every cell's value by the mean of its neighbours, because single outliers would
 * tear the picture. */
static void smooth_surface(struct iso_face_chip *chip, const uint8_t step[CELLS * CELLS])
{
    for (int i = 0; i < CELLS * CELLS; i++) {
        double mean;
        if (step[i] <= FILL_STEPS &&
            mean_of_neighbours(chip, step, i % CELLS, i / CELLS, FILL_STEPS + 1, &mean) > 0) {
            chip->surface_mm[i] = (float)(0.5 * ((double)chip->surface_mm[i] + mean));
        }
    }
}

/* The surface at a pixel of the picture, interpolated between the four cells around it. Returns
 * false if one of them is empty. */
static bool surface_at(const struct iso_face_chip *chip, const uint8_t step[CELLS * CELLS],
                       int column, int row, double *z_mm)
{
    const double x = fmin(fmax((column + 0.5) / ISO_FACE_CHIP_CELL - 0.5, 0.0), CELLS - 1.001);
    const double y = fmin(fmax((row + 0.5) / ISO_FACE_CHIP_CELL - 0.5, 0.0), CELLS - 1.001);
    const int c = (int)x, r = (int)y;
    const int at[4] = {r * CELLS + c, r * CELLS + c + 1, (r + 1) * CELLS + c,
                       (r + 1) * CELLS + c + 1};
    for (int k = 0; k < 4; k++) {
        if (step[at[k]] > FILL_STEPS) {
            return false;
        }
    }
    const float *s = chip->surface_mm;
    const double fx = x - c, fy = y - r;
    *z_mm = (1.0 - fy) * ((1.0 - fx) * (double)s[at[0]] + fx * (double)s[at[1]]) +
            fy * ((1.0 - fx) * (double)s[at[2]] + fx * (double)s[at[3]]);
    return true;
}

/* ---- the intensity on the surface ---- */

static int clamp_index(int i, int last)
{
    if (i < 0) {
        return 0;
    }
    return i > last ? last : i;
}

static double sample_intensity(const struct iso_frame *frame, int column, int row)
{
    const int c = clamp_index(column, frame->width_px - 1);
    const int r = clamp_index(row, frame->height_px - 1);
    return (double)frame->intensity[(size_t)r * (size_t)frame->width_px + (size_t)c];
}

/* The mean over the pixels of the frame that a pixel of the picture covers. If the pixels of the
 * frame are larger, it is interpolated between four of them. */
static double intensity_at(const struct iso_frame *frame, double u, double v, int window)
{
    if (window == 1) {
        const int c = (int)floor(u), r = (int)floor(v);
        const double fx = u - c, fy = v - r;
        return (1.0 - fy) * ((1.0 - fx) * sample_intensity(frame, c, r) +
                             fx * sample_intensity(frame, c + 1, r)) +
               fy * ((1.0 - fx) * sample_intensity(frame, c, r + 1) +
                     fx * sample_intensity(frame, c + 1, r + 1));
    }
    const int left = (int)floor(u - 0.5 * window + 1.0), top = (int)floor(v - 0.5 * window + 1.0);
    double sum = 0.0;
    for (int r = top; r < top + window; r++) {
        for (int c = left; c < left + window; c++) {
            sum += sample_intensity(frame, c, r);
        }
    }
    return sum / (window * window);
}

static bool in_middle(int column, int row)
{
    const int from = (SIDE - MIDDLE) / 2;
    return column >= from && column < from + MIDDLE && row >= from && row < from + MIDDLE;
}

/* Levels in the middle of the face, collected while the picture is drawn. */
struct middle {
    int n, saturated;
    float level[MIDDLE * MIDDLE], light[MIDDLE * MIDDLE];
};

static void note_middle(struct middle *middle, double level, double light)
{
    middle->level[middle->n] = (float)level;
    middle->light[middle->n++] = (float)light;
    middle->saturated += level >= saturated_level;
}

static void gather_light(struct iso_face_chip *chip, const struct iso_frame *frame,
                         const struct iso_rigid *camera_from_face,
                         const uint8_t step[CELLS * CELLS], struct middle *middle)
{
    const bool pinhole = frame->camera.projection == ISO_PINHOLE;
    const double pixel_mm = iso_camera_pixel_mm(&frame->camera, camera_from_face->translation_mm.z);
    const int window = (int)fmin(fmax(nearbyint(pitch_mm / pixel_mm), 1.0), WINDOW_MAX);
    for (int i = 0; i < SIDE * SIDE; i++) {
        const int column = i % SIDE, row = i / SIDE;
        double u, v, z_mm;
        chip->light[i] = -1.0F;
        if (!surface_at(chip, step, column, row, &z_mm)) {
            continue;
        }
        struct iso_vec3 p = iso_face_chip_place(column, row);
        p = iso_rigid_apply(camera_from_face, iso_vec3(p.x, p.y, z_mm));
        if (!iso_camera_project(&frame->camera, p, &u, &v)) {
            continue;
        }
        u -= frame->crop_x_px;
        v -= frame->crop_y_px;
        if (!(u >= 0.0 && u <= frame->width_px - 1 && v >= 0.0 && v <= frame->height_px - 1)) {
            continue;
        }
        const double level = intensity_at(frame, u, v, window);
        const double light = pinhole ? level * p.z * p.z : level;
        chip->light[i] = (float)light;
        const int cell = row / ISO_FACE_CHIP_CELL * CELLS + column / ISO_FACE_CHIP_CELL;
        if (in_middle(column, row) && step[cell] == 0) {
            note_middle(middle, level, light);
        }
    }
}

/* ---- the picture ---- */

static int by_value(const void *a, const void *b)
{
    const float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

static double median_value(float *values, int n)
{
    qsort(values, (size_t)n, sizeof *values, by_value);
    return (double)values[n / 2];
}

static double measure_grain(const uint8_t *picture)
{
    double difference = 0.0, sum = 0.0;
    for (int row = 0; row < SIDE; row++) {
        for (int column = 0; column < SIDE; column++) {
            if (!in_middle(column, row)) {
                continue;
            }
            const uint8_t *p = picture + row * SIDE + column;
            difference += fabs((double)p[0] - 0.25 * (p[-1] + p[1] + p[-SIDE] + p[SIDE]));
            sum += p[0];
        }
    }
    return sum > 0.0 ? difference / sum : 0.0;
}

static void develop_picture(struct iso_face_chip *chip, double light_of_middle)
{
    const double gain = light_of_middle > 0.0 ? middle_grey / light_of_middle : 0.0;
    for (int i = 0; i < SIDE * SIDE; i++) {
        chip->picture[i] = (uint8_t)clamp_value(nearbyint(gain * (double)chip->light[i]), 255);
    }
}

int iso_face_chip_draw(struct iso_face_chip *chip, const struct iso_frame *frame,
                       const struct iso_rigid *camera_from_face)
{
    uint8_t step[CELLS * CELLS];
    struct middle middle = {.n = 0};
    gather_surface(chip, frame, camera_from_face);
    fill_surface(chip, step);
    smooth_surface(chip, step);
    gather_light(chip, frame, camera_from_face, step, &middle);
    const double measured = middle.n / (double)(MIDDLE * MIDDLE);
    if (measured < measured_min) {
        return -ENODATA;
    }
    chip->measured = measured;
    chip->saturated = middle.saturated / (double)middle.n;
    chip->level = median_value(middle.level, middle.n);
    develop_picture(chip, median_value(middle.light, middle.n));
    chip->grain = measure_grain(chip->picture);
    return 0;
}
