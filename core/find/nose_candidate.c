#include "core/find/nose_candidate.h"

#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/lanes.h"
#include "core/base/wipe.h"
#include "core/find/ring_height.h"
#include "core/frame/depth_lanes.h"
#include "core/frame/distortion.h"

/* Sizes of a head, mm. */
static const double part_jump_mm = 40.0;    /* a larger step of depth separates two parts */
static const double part_area_mm2 = 6000.0; /* the least area of a part that may hold a face */
static const double height_max_mm = 60.0;
static const double apart_mm = 22.0; /* the least distance of two candidates */

/* A pixel is smoothed with those neighbours whose depths differ from its own by less than this. */
static const float same_surface_mm = 20.0f;

/* The planes of a finder have a border that is not measured: a row above the frame, one below it,
 * and a column after each row, which is also the one before the next row. So a pixel has all its
 * neighbours. Groups of ISO_DEPTHS pixels may begin at the last column. */
enum { BEFORE = ISO_DEPTHS, BEHIND = 2 * ISO_DEPTHS };

/* Marks of pixels in the plane `part` that belong to no part. The bytes of OUT_OF_RANGE are equal,
 * so that memset() can set it. */
enum { OUT_OF_RANGE = -1, UNLABELLED = -2 };

struct iso_candidate_finder {
    size_t capacity_px;
    float *depth_mm;  /* of the frame */
    int32_t *part;    /* the label of each pixel, or a mark */
    int32_t *queue;   /* pixels of the part that flood fill is finding; later high ones */
    float *height_mm; /* of each pixel above its ring; 0 for no candidate */
    double *column_line, *row_line; /* of the frame (ring_height.h) */
    struct iso_sight_lines lines;   /* these, or none */
    int32_t n_high;                 /* pixels in the queue that were given a height */
};

/* Sets the lines of sight of a frame's columns and rows, if its camera has such lines. */
static void set_lines(struct iso_candidate_finder *f, const struct iso_frame *frame)
{
    const struct iso_camera *c = &frame->camera;
    f->lines = (struct iso_sight_lines){NULL, NULL};
    if (c->projection != ISO_PINHOLE || iso_camera_is_distorted(c)) {
        return;
    }
    for (int column = 0; column < frame->width_px; column++) {
        f->column_line[column] = iso_sight_line(column, frame->crop_x_px, c->cx_px, c->fx_px);
    }
    for (int row = 0; row < frame->height_px; row++) {
        f->row_line[row] = iso_sight_line(row, frame->crop_y_px, c->cy_px, c->fy_px);
    }
    f->lines = (struct iso_sight_lines){f->column_line, f->row_line};
}

/* A connected piece of surface. */
struct part {
    int32_t label;
    double mean_mm;
};

static int pitch_of(const struct iso_frame *frame)
{
    return frame->width_px + 1;
}

/* Where a pixel is in the planes. */
static int index_of(const struct iso_frame *frame, int column, int row)
{
    return BEFORE + (row + 1) * pitch_of(frame) + column;
}

int iso_candidate_finder_new(size_t capacity_px, struct iso_candidate_finder **out)
{
    struct iso_candidate_finder *f = calloc(1, sizeof *f);
    if (f) {
        /* The border is largest if the frame has one row. */
        const size_t n = 3 * (capacity_px + 1) + BEFORE + BEHIND;
        f->capacity_px = capacity_px;
        f->depth_mm = calloc(n, sizeof *f->depth_mm);
        f->part = calloc(n, sizeof *f->part);
        f->queue = calloc(capacity_px, sizeof *f->queue);
        f->height_mm = calloc(n, sizeof *f->height_mm);
        f->column_line = calloc(capacity_px, sizeof *f->column_line);
        f->row_line = calloc(capacity_px, sizeof *f->row_line);
    }
    if (!f || !f->depth_mm || !f->part || !f->queue || !f->height_mm || !f->column_line ||
        !f->row_line) {
        iso_candidate_finder_free(f);
        return -ENOMEM;
    }
    *out = f;
    return 0;
}

void iso_candidate_finder_free(struct iso_candidate_finder *finder)
{
    if (finder) {
        iso_wipe_free(finder->depth_mm);
        free(finder->part);
        free(finder->queue);
        iso_wipe_free(finder->height_mm);
        free(finder->column_line);
        free(finder->row_line);
        free(finder);
    }
}

/* Copies the frame into the planes, and marks the pixels within the range of depths. Returns how
 * many these are. */
static int take_in(struct iso_candidate_finder *f, const struct iso_frame *frame,
                   const struct iso_candidate_options *options)
{
    const int w = frame->width_px, h = frame->height_px;
    const size_t n = (size_t)index_of(frame, 0, h + 1) + BEHIND;
    int n_in_range = 0;
    memset(f->depth_mm, 0, n * sizeof *f->depth_mm);
    memset(f->height_mm, 0, n * sizeof *f->height_mm);
    memset(f->part, 0xff, n * sizeof *f->part);
    for (int row = 0; row < h; row++) {
        const int at = index_of(frame, 0, row);
        memcpy(&f->depth_mm[at], &frame->depth_mm[(size_t)row * (size_t)w],
               (size_t)w * sizeof *f->depth_mm);
        for (int i = at; i < at + w; i++) {
            const double z = (double)f->depth_mm[i];
            const bool in_range = z > 0.0 && z >= options->near_mm && z <= options->far_mm;
            f->part[i] = in_range ? UNLABELLED : OUT_OF_RANGE;
            n_in_range += in_range;
        }
    }
    return n_in_range;
}

/* Labels the part that holds `seed`. Returns its area, mm^2, and its mean depth. */
static double flood_part(struct iso_candidate_finder *f, const struct iso_frame *frame, int seed,
                         int32_t label, double *mean_mm)
{
    const int pitch = pitch_of(frame), next[4] = {-1, 1, -pitch, pitch};
    const double pixel_mm = iso_camera_pixel_mm(&frame->camera, 1.0);
    int head = 0, tail = 0;
    double sum_z = 0.0, sum_zz = 0.0;
    f->queue[tail++] = seed;
    f->part[seed] = label;
    while (head < tail) {
        const int at = f->queue[head++];
        const double z = (double)f->depth_mm[at];
        sum_z += z;
        sum_zz += z * z;
        for (int k = 0; k < 4; k++) {
            const int to = at + next[k];
            if (f->part[to] == UNLABELLED && fabs(z - (double)f->depth_mm[to]) <= part_jump_mm) {
                f->part[to] = label;
                f->queue[tail++] = to;
            }
        }
    }
    *mean_mm = sum_z / tail;
    /* A pixel of an orthographic image is as large at every depth. */
    return pixel_mm * pixel_mm * (frame->camera.projection == ISO_PINHOLE ? sum_zz : tail);
}

/* Finds the nearest parts that may hold a face, sorted from near to far. Returns how many. */
static int find_parts(struct iso_candidate_finder *f, const struct iso_frame *frame,
                      struct part parts[ISO_CANDIDATE_PARTS_MAX])
{
    const int end = index_of(frame, 0, frame->height_px);
    int n = 0;
    int32_t label = 0;
    for (int i = index_of(frame, 0, 0); i < end; i++) {
        if (f->part[i] != UNLABELLED) {
            continue;
        }
        double mean;
        const double area = flood_part(f, frame, i, label, &mean);
        if (area >= part_area_mm2) {
            int at = n < ISO_CANDIDATE_PARTS_MAX ? n++ : n;
            for (; at > 0 && parts[at - 1].mean_mm > mean; at--) {
                if (at < ISO_CANDIDATE_PARTS_MAX) {
                    parts[at] = parts[at - 1];
                }
            }
            if (at < ISO_CANDIDATE_PARTS_MAX) {
                parts[at] = (struct part){label, mean};
            }
        }
        label++;
    }
    return n;
}

/* Smooths ISO_DEPTHS pixels, which begin at `at` in a plane: the result for a pixel is the mean of
 * those depths of its 3 x 3 neighbourhood that lie on the same surface. The pixels must be
 * measured. A float has 24 bits, and the depths differ by less than 20 mm: so from a depth of 150
 * mm on, the differences and their sums are exact. */
static void smooth_depths(const float *at, int pitch, double mean_mm[ISO_DEPTHS])
{
    const iso_depths z = ISO_DEPTHS_LOAD(at);
    iso_depths sum = {0.0f};
    iso_depth_counts n = {0};
    for (int row = -1; row <= 1; row++) {
        for (int column = -1; column <= 1; column++) {
            const iso_depths near = ISO_DEPTHS_LOAD(&at[row * pitch + column]), apart = near - z;
            const iso_depth_counts is = (near > 0.0f) & (apart < same_surface_mm) &
                                        (apart > -same_surface_mm);
            sum += (iso_depths)((iso_depth_counts)apart & is);
            n -= is;
        }
    }
    const iso_doubles count = __builtin_convertvector(n, iso_doubles);
    ISO_DOUBLES_STORE(mean_mm, (count * __builtin_convertvector(z, iso_doubles) +
                                __builtin_convertvector(sum, iso_doubles)) /
                                   count);
}

static bool is_of_parts(int32_t label, const struct part *parts, int n_parts)
{
    for (int p = 0; p < n_parts; p++) {
        if (parts[p].label == label) {
            return true;
        }
    }
    return false;
}

/* Measures the heights of up to ISO_DEPTHS pixels of a row that belong to the parts. */
static void measure_heights(struct iso_candidate_finder *f, const struct iso_frame *frame,
                            int column, int row, const struct part *parts, int n_parts)
{
    const int first = index_of(frame, column, row), left = frame->width_px - column;
    const int n = left < ISO_DEPTHS ? left : ISO_DEPTHS;
    unsigned wanted = 0;
    for (int k = 0; k < n; k++) {
        wanted |= (unsigned)is_of_parts(f->part[first + k], parts, n_parts) << k;
    }
    if (!wanted) {
        return;
    }
    double z_mm[ISO_DEPTHS];
    _Static_assert(ISO_RINGS == (int)ISO_DEPTHS, "a group of pixels");
    smooth_depths(&f->depth_mm[first], pitch_of(frame), z_mm);
    if (wanted == (1u << ISO_DEPTHS) - 1) {
        wanted &= ~iso_rings_are_low(frame, column, row, z_mm);
    }
    for (int k = 0; k < n; k++) {
        const double height = wanted >> k & 1
                                  ? iso_ring_height(frame, &f->lines, column + k, row, z_mm[k])
                                  : 0.0;
        if (height >= ISO_RING_HEIGHT_MIN_MM && height <= height_max_mm) {
            f->height_mm[first + k] = (float)height;
            f->queue[f->n_high++] = first + k;
        }
    }
}

/* The highest pixel of a part, or -1 if none is left. The pixel and its surroundings are removed
 * from the search. */
static int take_highest(struct iso_candidate_finder *f, const struct iso_frame *frame,
                        int32_t label)
{
    int best = -1;
    for (int i = 0; i < f->n_high; i++) {
        const int at = f->queue[i];
        if (f->part[at] == label && f->height_mm[at] > (best < 0 ? 0.0f : f->height_mm[best])) {
            best = at;
        }
    }
    if (best < 0) {
        return -1;
    }
    const int pitch = pitch_of(frame), inside = best - index_of(frame, 0, 0);
    int column = inside % pitch, row = inside / pitch;
    const double z = (double)f->depth_mm[best];
    const int reach = (int)ceil(apart_mm / iso_camera_pixel_mm(&frame->camera, z));
    for (int v = row - reach; v <= row + reach; v++) {
        for (int u = column - reach; u <= column + reach; u++) {
            if (u >= 0 && v >= 0 && u < frame->width_px && v < frame->height_px) {
                f->height_mm[index_of(frame, u, v)] = 0.0f;
            }
        }
    }
    return inside;
}

/* The candidate at a place that take_highest() found. */
static struct iso_nose_candidate candidate_at(const struct iso_candidate_finder *f,
                                              const struct iso_frame *frame, int inside, int part)
{
    const int pitch = pitch_of(frame), column = inside % pitch, row = inside / pitch;
    double z_mm[ISO_DEPTHS];
    smooth_depths(&f->depth_mm[index_of(frame, column, row)], pitch, z_mm);
    const struct iso_vec3 point_mm = iso_camera_back_project(
        &frame->camera, column + frame->crop_x_px, row + frame->crop_y_px, z_mm[0]);
    return (struct iso_nose_candidate){
        .point_mm = point_mm,
        .height_mm = iso_ring_height(frame, &f->lines, column, row, z_mm[0]),
        .stands_out_mm = iso_ring_stands_out(frame, column, row, z_mm[0]),
        .part = part,
    };
}

int iso_candidates_find(struct iso_candidate_finder *f, const struct iso_frame *frame,
                        const struct iso_candidate_options *options,
                        struct iso_nose_candidate candidates[ISO_CANDIDATES_MAX], int *n_candidates,
                        int *n_parts)
{
    if ((size_t)frame->width_px * (size_t)frame->height_px > f->capacity_px) {
        return -ENOSPC;
    }
    struct part parts[ISO_CANDIDATE_PARTS_MAX];
    const bool any = take_in(f, frame, options) > 0;
    set_lines(f, frame);
    int found_parts = any ? find_parts(f, frame, parts) : 0, n = 0;
    f->n_high = 0;
    for (int row = 0; found_parts > 0 && row < frame->height_px; row++) {
        for (int column = 0; column < frame->width_px; column += ISO_DEPTHS) {
            measure_heights(f, frame, column, row, parts, found_parts);
        }
    }
    for (int p = 0; p < found_parts; p++) {
        for (int k = 0; k < ISO_CANDIDATES_PER_PART && n < ISO_CANDIDATES_MAX; k++) {
            const int at = take_highest(f, frame, parts[p].label);
            if (at < 0) {
                break;
            }
            candidates[n++] = candidate_at(f, frame, at, p);
        }
    }
    *n_candidates = n;
    *n_parts = found_parts;
    return 0;
}
