#include "core/presentation/sheet.h"

#include <errno.h>
#include <stdbool.h>
#include <stdlib.h>

#include "core/base/wipe.h"

static const double area_min_mm2 = 6000.0;
/* A step of depth between neighbours ends a part if it exceeds both 12 mm and a slope of 70
 * degrees. */
static const double jump_mm = 12.0, jump_slope = 2.75;
/* The widest hole that a part reaches across. */
static const double across_mm = 200.0;
/* The residual limit up to 600 mm: four times the noise of stereo there. It grows with the distance
 * beyond. */
static const double limit_mm = 6.0, limit_at_mm = 600.0;

enum { SAMPLES = 500 };

struct iso_sheet_finder {
    size_t capacity_px;
    int32_t *label;                         /* of each pixel, -1 for none */
    int32_t *queue;                         /* flood fill */
    int32_t *first_row, *last_row;          /* of the part in each column */
    struct iso_vec3 points_mm[2 * SAMPLES]; /* of the part, about its middle */
};

struct part {
    int32_t label;
    int pixels;
    double area_mm2, mean_mm;
};

int iso_sheet_finder_new(size_t capacity_px, struct iso_sheet_finder **out)
{
    if (capacity_px == 0 || capacity_px > INT32_MAX) {
        return -EINVAL;
    }
    struct iso_sheet_finder *f = calloc(1, sizeof *f);
    if (f) {
        f->capacity_px = capacity_px;
        f->label = calloc(capacity_px, sizeof *f->label);
        f->queue = calloc(capacity_px, sizeof *f->queue);
        f->first_row = calloc(capacity_px, sizeof *f->first_row);
        f->last_row = calloc(capacity_px, sizeof *f->last_row);
    }
    if (!f || !f->label || !f->queue || !f->first_row || !f->last_row) {
        iso_sheet_finder_free(f);
        return -ENOMEM;
    }
    *out = f;
    return 0;
}

void iso_sheet_finder_free(struct iso_sheet_finder *finder)
{
    if (finder) {
        free(finder->label);
        free(finder->queue);
        free(finder->first_row);
        free(finder->last_row);
        iso_wipe_free(finder);
    }
}

static bool in_range(double z_mm, double near_mm, double far_mm)
{
    return z_mm > 0.0 && z_mm >= near_mm && z_mm <= far_mm;
}

/* The next measured pixel from one in a direction, across holes; -1 if there is none. */
static int next_measured(const struct iso_frame *frame, int column, int row, int du, int dv,
                         int reach)
{
    for (int k = 1; k <= reach; k++) {
        int u = column + k * du, v = row + k * dv;
        if (u < 0 || v < 0 || u >= frame->width_px || v >= frame->height_px) {
            return -1;
        }
        if (iso_frame_depth_at(frame, u, v) > 0.0f) {
            return v * frame->width_px + u;
        }
    }
    return -1;
}

static struct part flood_part(struct iso_sheet_finder *f, const struct iso_frame *frame, int seed,
                              int32_t label, double near_mm, double far_mm)
{
    static const int steps[4][2] = {{1, 0}, {-1, 0}, {0, 1}, {0, -1}};
    int head = 0, tail = 0, w = frame->width_px;
    struct part part = {.label = label};
    f->queue[tail++] = seed;
    f->label[seed] = label;
    while (head < tail) {
        const int at = f->queue[head++], column = at % w, row = at / w;
        const double z = (double)frame->depth_mm[at];
        const double pixel = iso_camera_pixel_mm(&frame->camera, z);
        const double jump = jump_slope * pixel > jump_mm ? jump_slope * pixel : jump_mm;
        const int reach = (int)(across_mm / pixel);
        part.area_mm2 += pixel * pixel;
        part.mean_mm += z;
        for (int k = 0; k < 4; k++) {
            const int to = next_measured(frame, column, row, steps[k][0], steps[k][1], reach);
            if (to < 0 || f->label[to] >= 0) {
                continue;
            }
            const double other = (double)frame->depth_mm[to];
            if (in_range(other, near_mm, far_mm) && fabs(other - z) <= jump) {
                f->label[to] = label;
                f->queue[tail++] = to;
            }
        }
    }
    part.pixels = tail;
    part.mean_mm /= tail;
    return part;
}

/* Picks points of a part at even steps, relative to their mean. Returns how many, at most
 * 2 * SAMPLES. */
static int sample_points(const struct iso_sheet_finder *f, const struct iso_frame *frame,
                         const struct part *part, struct iso_vec3 points[2 * SAMPLES])
{
    int every = part->pixels / SAMPLES + 1, seen = 0, n = 0;
    struct iso_vec3 middle = {0, 0, 0};
    for (int i = 0; i < frame->width_px * frame->height_px; i++) {
        if (f->label[i] == part->label && seen++ % every == 0) {
            points[n] = iso_frame_point_at(frame, i % frame->width_px, i / frame->width_px);
            middle = iso_add(middle, points[n++]);
        }
    }
    for (int i = 0; i < n; i++) {
        points[i] = iso_madd(points[i], -1.0 / n, middle);
    }
    return n;
}

/* Counts the pixels between the part's outermost ones, in rows and in columns. */
static void describe_outline(struct iso_sheet_finder *f, const struct iso_frame *frame,
                             const struct part *part, struct iso_sheet *out)
{
    int w = frame->width_px, h = frame->height_px, inside = 0, holes = 0, ends = 0, at_border = 0;
    for (int column = 0; column < w; column++) {
        f->first_row[column] = h;
        f->last_row[column] = -1;
        for (int row = 0; row < h; row++) {
            if (f->label[row * w + column] == part->label) {
                f->first_row[column] = row < f->first_row[column] ? row : f->first_row[column];
                f->last_row[column] = row;
            }
        }
        if (f->last_row[column] >= 0) {
            ends += 2;
            at_border += (f->first_row[column] == 0) + (f->last_row[column] == h - 1);
        }
    }
    for (int row = 0; row < h; row++) {
        int first = 0, last = w - 1;
        while (first < w && f->label[row * w + first] != part->label) {
            first++;
        }
        while (last >= first && f->label[row * w + last] != part->label) {
            last--;
        }
        if (last < first) {
            continue;
        }
        ends += 2;
        at_border += (first == 0) + (last == w - 1);
        for (int column = first; column <= last; column++) {
            if (row >= f->first_row[column] && row <= f->last_row[column]) {
                inside++;
                holes += !(frame->depth_mm[row * w + column] > 0.0f);
            }
        }
    }
    out->border_share = ends > 0 ? (double)at_border / ends : 0.0;
    out->hole_share = inside > 0 ? (double)holes / inside : 0.0;
}

/* Of a part that is larger than held_max_mm2, only the plane is fitted. */
static int describe_sheet(struct iso_sheet_finder *f, const struct iso_frame *frame,
                          const struct part *part, double held_max_mm2, struct iso_sheet *out)
{
    struct iso_vec3 *points = f->points_mm;
    double plane[3], farther = part->mean_mm / limit_at_mm;
    struct iso_sheet sheet = {.area_mm2 = part->area_mm2,
                              .distance_mm = part->mean_mm,
                              .limit_mm = limit_mm * fmax(1.0, farther)};
    const int n = sample_points(f, frame, part, points);
    const bool held = sheet.area_mm2 <= held_max_mm2;
    int error = iso_plane_fit(points, n, sheet.limit_mm, plane, &sheet.flat);
    if (!error && held) {
        error = iso_bent_sheet_fit(points, n, sheet.limit_mm, &sheet.bent);
    }
    if (!error && held) {
        describe_outline(f, frame, part, &sheet);
    }
    if (!error) {
        *out = sheet;
    }
    return error;
}

int iso_sheet_find(struct iso_sheet_finder *finder, const struct iso_frame *coarse, double near_mm,
                   double far_mm, double held_max_mm2, struct iso_sheet *out)
{
    const int n_px = coarse->width_px * coarse->height_px;
    int32_t label = 0;
    struct part nearest = {.mean_mm = INFINITY};
    if ((size_t)n_px > finder->capacity_px) {
        return -ENOSPC;
    }
    for (int i = 0; i < n_px; i++) {
        finder->label[i] = -1;
    }
    for (int i = 0; i < n_px; i++) {
        if (finder->label[i] >= 0 || !in_range((double)coarse->depth_mm[i], near_mm, far_mm)) {
            continue;
        }
        struct part part = flood_part(finder, coarse, i, label++, near_mm, far_mm);
        if (part.area_mm2 >= area_min_mm2 && part.mean_mm < nearest.mean_mm) {
            nearest = part;
        }
    }
    if (!isfinite(nearest.mean_mm) || describe_sheet(finder, coarse, &nearest, held_max_mm2, out)) {
        return -ENOENT;
    }
    return 0;
}
