#include "core/find/nose_candidate.h"

#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>

#include "core/base/solve.h"
#include "core/base/wipe.h"

/* Sizes of a head, mm. */
static const double part_jump_mm = 40.0;    /* a larger step of depth separates two parts */
static const double part_area_mm2 = 6000.0; /* the least area of a part that may hold a face */
static const double ring_radius_mm = 40.0;
static const double ring_reach_mm = 70.0; /* ring points further off in depth are not the face */
static const double height_min_mm = 7.0;
static const double height_max_mm = 60.0;
static const double low_mm = 2.0;    /* a lower mean of four ring points is surely no nose */
static const double apart_mm = 22.0; /* the least distance of two candidates */

enum { RING = 16, RING_MIN = 9 };

struct iso_candidate_finder {
    size_t capacity_px;
    int32_t *part;    /* of each pixel, -1 for none */
    int32_t *queue;   /* pixels of the part that flood fill is finding */
    float *height_mm; /* of each pixel above its ring; 0 for no candidate */
};

/* A connected piece of surface. */
struct part {
    int32_t label;
    double mean_mm;
};

int iso_candidate_finder_new(size_t capacity_px, struct iso_candidate_finder **out)
{
    struct iso_candidate_finder *f = calloc(1, sizeof *f);
    if (f) {
        f->capacity_px = capacity_px;
        f->part = calloc(capacity_px, sizeof *f->part);
        f->queue = calloc(capacity_px, sizeof *f->queue);
        f->height_mm = calloc(capacity_px, sizeof *f->height_mm);
    }
    if (!f || !f->part || !f->queue || !f->height_mm) {
        iso_candidate_finder_free(f);
        return -ENOMEM;
    }
    *out = f;
    return 0;
}

void iso_candidate_finder_free(struct iso_candidate_finder *finder)
{
    if (finder) {
        free(finder->part);
        free(finder->queue);
        iso_wipe_free(finder->height_mm);
        free(finder);
    }
}

static bool are_joined(const struct iso_frame *frame, int a, int b,
                       const struct iso_candidate_options *options)
{
    double za = (double)frame->depth_mm[a], zb = (double)frame->depth_mm[b];
    return zb > 0.0 && zb >= options->near_mm && zb <= options->far_mm &&
           fabs(za - zb) <= part_jump_mm;
}

/* Labels the part that holds `seed`. Returns its area, mm^2, and its mean depth. */
static double flood_part(struct iso_candidate_finder *f, const struct iso_frame *frame, int seed,
                         int32_t label, const struct iso_candidate_options *options,
                         double *mean_mm)
{
    int w = frame->width_px, h = frame->height_px, head = 0, tail = 0;
    double area = 0.0, sum_z = 0.0;
    f->queue[tail++] = seed;
    f->part[seed] = label;
    while (head < tail) {
        int at = f->queue[head++], column = at % w, row = at / w;
        const double z = (double)frame->depth_mm[at];
        const double pixel = iso_camera_pixel_mm(&frame->camera, z);
        area += pixel * pixel;
        sum_z += z;
        const int next[4] = {column > 0 ? at - 1 : -1, column < w - 1 ? at + 1 : -1,
                             row > 0 ? at - w : -1, row < h - 1 ? at + w : -1};
        for (int k = 0; k < 4; k++) {
            if (next[k] >= 0 && f->part[next[k]] < 0 && are_joined(frame, at, next[k], options)) {
                f->part[next[k]] = label;
                f->queue[tail++] = next[k];
            }
        }
    }
    *mean_mm = sum_z / tail;
    return area;
}

/* Finds the nearest parts that may hold a face, sorted from near to far. Returns how many. */
static int find_parts(struct iso_candidate_finder *f, const struct iso_frame *frame,
                      const struct iso_candidate_options *options,
                      struct part parts[ISO_CANDIDATE_PARTS_MAX])
{
    int n_px = frame->width_px * frame->height_px, n = 0;
    int32_t label = 0;
    for (int i = 0; i < n_px; i++) {
        f->part[i] = -1;
    }
    for (int i = 0; i < n_px; i++) {
        if (f->part[i] >= 0 || !are_joined(frame, i, i, options)) {
            continue;
        }
        double mean;
        const double area = flood_part(f, frame, i, label, options, &mean);
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

/* The point that a pixel sees, with the mean depth of those of its 3 x 3 surroundings that lie on
 * the same surface. */
static struct iso_vec3 smoothed_point(const struct iso_frame *frame, int column, int row)
{
    double z = (double)iso_frame_depth_at(frame, column, row), sum = 0.0;
    int n = 0;
    for (int v = row - 1; v <= row + 1; v++) {
        for (int u = column - 1; u <= column + 1; u++) {
            if (u < 0 || v < 0 || u >= frame->width_px || v >= frame->height_px) {
                continue;
            }
            const double near = (double)iso_frame_depth_at(frame, u, v);
            if (near > 0.0 && fabs(near - z) < ring_radius_mm / 2) {
                sum += near;
                n++;
            }
        }
    }
    return iso_camera_back_project(&frame->camera, column + frame->crop_x_px,
                                   row + frame->crop_y_px, n > 0 ? sum / n : z);
}

/* cos(2 pi k / RING) */
static const double ring_cosine[RING] = {
    1.0,  0.92387953,  0.70710678,  0.38268343,  0.0, -0.38268343, -0.70710678, -0.92387953,
    -1.0, -0.92387953, -0.70710678, -0.38268343, 0.0, 0.38268343,  0.70710678,  0.92387953};

/* Whether a place is certainly not high. This quick check needs only four points of the ring, two
 * opposite pairs, all of them on the surface. Most pixels then need no check of the whole ring. */
static bool surely_low(const struct iso_frame *frame, int column, int row, double z_mm,
                       double radius_px)
{
    const int reach = (int)lrint(radius_px);
    if (column < reach || row < reach || column + reach >= frame->width_px ||
        row + reach >= frame->height_px) {
        return false;
    }
    const double ring[4] = {(double)iso_frame_depth_at(frame, column - reach, row),
                            (double)iso_frame_depth_at(frame, column + reach, row),
                            (double)iso_frame_depth_at(frame, column, row - reach),
                            (double)iso_frame_depth_at(frame, column, row + reach)};
    double sum = 0.0;
    for (int k = 0; k < 4; k++) {
        if (!(ring[k] > 0.0) || fabs(ring[k] - z_mm) > ring_reach_mm) {
            return false;
        }
        sum += ring[k];
    }
    return sum / 4.0 - z_mm < low_mm;
}

/* Height of a pixel towards the camera, above the least-squares plane z = a + b dx + c dy through
 * the ring about the pixel, along the normal of the plane. 0 if the place is surely low, or if too
 * few points of the ring were measured. */
static double height_above_ring(const struct iso_frame *frame, int column, int row)
{
    const struct iso_vec3 centre = smoothed_point(frame, column, row);
    const double radius_px = ring_radius_mm / iso_camera_pixel_mm(&frame->camera, centre.z);
    if (surely_low(frame, column, row, centre.z, radius_px)) {
        return 0.0;
    }
    double normal[9] = {0}, right[3] = {0};
    int n = 0;
    for (int k = 0; k < RING; k++) {
        const int u = (int)lrint(column + radius_px * ring_cosine[k % RING]);
        const int v = (int)lrint(row + radius_px * ring_cosine[(k + 3 * RING / 4) % RING]);
        if (u < 0 || v < 0 || u >= frame->width_px || v >= frame->height_px) {
            continue;
        }
        const double z = (double)iso_frame_depth_at(frame, u, v);
        if (!(z > 0.0) || fabs(z - centre.z) > ring_reach_mm) {
            continue;
        }
        const struct iso_vec3 d = iso_sub(iso_frame_point_at(frame, u, v), centre);
        const double x[3] = {1.0, d.x, d.y};
        for (int i = 0; i < 3; i++) {
            for (int j = 0; j < 3; j++) {
                normal[3 * i + j] += x[i] * x[j];
            }
            right[i] += x[i] * d.z;
        }
        n++;
    }
    if (n < RING_MIN || iso_cholesky_factorise(normal, 3)) {
        return 0.0;
    }
    iso_cholesky_solve(normal, 3, right);
    return right[0] / sqrt(1.0 + right[1] * right[1] + right[2] * right[2]);
}

/* The highest pixel of a part, or -1 if none is left. The pixel and its surroundings are removed
 * from the search. */
static int take_highest(struct iso_candidate_finder *f, const struct iso_frame *frame,
                        int32_t label)
{
    int n_px = frame->width_px * frame->height_px, best = -1;
    for (int i = 0; i < n_px; i++) {
        if (f->part[i] == label && f->height_mm[i] > (best < 0 ? 0.0f : f->height_mm[best])) {
            best = i;
        }
    }
    if (best < 0) {
        return -1;
    }
    int column = best % frame->width_px, row = best / frame->width_px;
    const double z = (double)frame->depth_mm[best];
    const int reach = (int)ceil(apart_mm / iso_camera_pixel_mm(&frame->camera, z));
    for (int v = row - reach; v <= row + reach; v++) {
        for (int u = column - reach; u <= column + reach; u++) {
            if (u >= 0 && v >= 0 && u < frame->width_px && v < frame->height_px) {
                f->height_mm[v * frame->width_px + u] = 0.0f;
            }
        }
    }
    return best;
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
    int found_parts = find_parts(f, frame, options, parts), n = 0;
    for (int i = 0; i < frame->width_px * frame->height_px; i++) {
        double height = 0.0;
        for (int p = 0; p < found_parts && height <= 0.0; p++) {
            if (f->part[i] == parts[p].label) {
                height = height_above_ring(frame, i % frame->width_px, i / frame->width_px);
            }
        }
        f->height_mm[i] = height >= height_min_mm && height <= height_max_mm ? (float)height : 0.0f;
    }
    for (int p = 0; p < found_parts; p++) {
        for (int k = 0; k < ISO_CANDIDATES_PER_PART && n < ISO_CANDIDATES_MAX; k++) {
            const int at = take_highest(f, frame, parts[p].label);
            if (at < 0) {
                break;
            }
            int column = at % frame->width_px, row = at / frame->width_px;
            const struct iso_vec3 point = smoothed_point(frame, column, row);
            candidates[n++] = (struct iso_nose_candidate){point,
                                                          height_above_ring(frame, column, row), p};
        }
    }
    *n_candidates = n;
    *n_parts = found_parts;
    return 0;
}
