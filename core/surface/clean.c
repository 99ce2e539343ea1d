#include "core/surface/clean.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/frame/depth_lanes.h"
#include "core/frame/depth_step.h"
#include "core/frame/shrink.h"

/* Two bounds on differences in depth. Both are raised to bound_steps times the step of the depths
 * (depth_step.h) if this is more, so that a pixel may differ by one step, but not by two. */
static const float neighbour_mm = 8.0f;
static const float median_mm = 6.0f;
static const double bound_steps = 1.25;
static const double piece_mm2 = 3000.0;

enum { NEIGHBOURS_MIN = 5 };

/* Floats behind a plane that may be read and written when the last pixels of a row are treated
 * ISO_DEPTHS at a time. */
enum { SLACK = 2 * ISO_DEPTHS };

/* A pixel that differs by more, mm, from a neighbour or from the median is not on the same surface.
 */
struct bounds {
    float neighbour_mm, median_mm;
};

struct iso_cleaner {
    size_t capacity_px;
    struct iso_frame frame; /* the result */
    float *kept;            /* the second plane, to which the kept pixels are written */
    int32_t *queue;         /* pixels of the piece that flood fill is finding */
    uint8_t *seen;          /* 1 for pixels that already belong to a piece */
};

int iso_cleaner_new(size_t capacity_px, struct iso_cleaner **out)
{
    if (capacity_px == 0) {
        return -EINVAL;
    }
    struct iso_cleaner *c = calloc(1, sizeof *c);
    if (c) {
        c->capacity_px = capacity_px;
        c->frame.depth_mm = calloc(capacity_px + SLACK, sizeof *c->frame.depth_mm);
        c->kept = calloc(capacity_px + SLACK, sizeof *c->kept);
        c->queue = calloc(capacity_px, sizeof *c->queue);
        c->seen = calloc(capacity_px, sizeof *c->seen);
    }
    if (!c || !c->frame.depth_mm || !c->kept || !c->queue || !c->seen) {
        iso_cleaner_free(c);
        return -ENOMEM;
    }
    *out = c;
    return 0;
}

void iso_cleaner_free(struct iso_cleaner *cleaner)
{
    if (cleaner) {
        float *const planes[] = {cleaner->frame.depth_mm, cleaner->kept}; /* biometric data */
        for (size_t i = 0; i < sizeof planes / sizeof *planes; i++) {
            if (planes[i]) {
                explicit_bzero(planes[i], (cleaner->capacity_px + SLACK) * sizeof *planes[i]);
            }
        }
        free(cleaner->frame.depth_mm);
        free(cleaner->kept);
        free(cleaner->queue);
        free(cleaner->seen);
        free(cleaner);
    }
}

/* The pixels of the square that lie in the frame; all zero if there are none. */
static struct iso_window window_about(const struct iso_frame *frame, struct iso_vec3 centre_mm,
                                      double radius_mm)
{
    const struct iso_window none = {0};
    double u, v;
    if (!iso_camera_project(&frame->camera, centre_mm, &u, &v)) {
        return none;
    }
    const double reach = radius_mm / iso_camera_pixel_mm(&frame->camera, centre_mm.z);
    const double left = fmax(ceil(u - frame->crop_x_px - reach), 0.0);
    double top = fmax(ceil(v - frame->crop_y_px - reach), 0.0);
    const double right = fmin(floor(u - frame->crop_x_px + reach), frame->width_px - 1.0);
    const double bottom = fmin(floor(v - frame->crop_y_px + reach), frame->height_px - 1.0);
    if (!(left <= right && top <= bottom)) {
        return none;
    }
    return (struct iso_window){(int)left, (int)top, (int)(right - left) + 1,
                               (int)(bottom - top) + 1};
}

static struct bounds bounds_of(const struct iso_frame *frame)
{
    const float coarse_mm = (float)(bound_steps * iso_depth_step(frame));
    return (struct bounds){fmaxf(neighbour_mm, coarse_mm), fmaxf(median_mm, coarse_mm)};
}

/* Writes the ISO_DEPTHS pixels from `at` on, which are two or more from the border, to `to`: the
 * depths of those of the first n that agree with their surroundings, and 0 for the others. The
 * distance from the median is checked by counting, without sorting: a pixel lies within the bound
 * of the median if at most half of the measured pixels lie further than the bound in front of it,
 * and at most half lie further behind it. */
static void keep_agreeing(const float *at, int width, struct bounds bounds, int n, float *to)
{
    const iso_depth_counts lane = {0, 1, 2, 3};
    const iso_depths z = ISO_DEPTHS_LOAD(at);
    iso_depth_counts close = {0}, measured = {0}, below = {0}, above = {0};
    for (int dv = -2; dv <= 2; dv++) {
        for (int du = -2; du <= 2; du++) {
            const iso_depths near = ISO_DEPTHS_LOAD(&at[dv * width + du]), d = near - z;
            const iso_depth_counts is = near > 0.0f;
            measured -= is;
            below -= is & (d < -bounds.median_mm);
            above -= is & (d > bounds.median_mm);
            if ((du | dv) != 0 && du >= -1 && du <= 1 && dv >= -1 && dv <= 1) {
                close -= is & (d < bounds.neighbour_mm) & (d > -bounds.neighbour_mm);
            }
        }
    }
    const iso_depth_counts keep = (lane < n) & (z > 0.0f) & (close >= NEIGHBOURS_MIN) &
                                  (2 * below <= measured) & (2 * above <= measured);
    ISO_DEPTHS_STORE(to, (iso_depths)((iso_depth_counts)z & keep));
}

/* The kept pixels become those that agree with their surroundings; none at the border. The last
 * group of a row may reach into the next row, which is written later, or into the slack behind the
 * plane. */
static void drop_outliers(struct iso_cleaner *c, struct bounds bounds)
{
    struct iso_frame *f = &c->frame;
    int w = f->width_px, h = f->height_px;
    memset(c->kept, 0, (size_t)w * (size_t)h * sizeof *c->kept);
    for (int row = 2; row < h - 2; row++) {
        for (int column = 2; column < w - 2; column += ISO_DEPTHS) {
            const int at = row * w + column;
            keep_agreeing(&f->depth_mm[at], w, bounds, w - 2 - column, &c->kept[at]);
        }
    }
    float *swap = f->depth_mm;
    f->depth_mm = c->kept;
    c->kept = swap;
}

/* Flood fill from a seed. The pixels stay in the queue. Returns their number and their area. */
static int flood(struct iso_cleaner *c, int seed, float limit_mm, double *area_mm2)
{
    const struct iso_frame *f = &c->frame;
    int w = f->width_px, h = f->height_px, head = 0, tail = 0;
    double area = 0.0;
    c->queue[tail++] = seed;
    c->seen[seed] = 1;
    while (head < tail) {
        int at = c->queue[head++], column = at % w, row = at / w;
        const double pixel = iso_camera_pixel_mm(&f->camera, (double)f->depth_mm[at]);
        area += pixel * pixel;
        const int next[4] = {column > 0 ? at - 1 : -1, column < w - 1 ? at + 1 : -1,
                             row > 0 ? at - w : -1, row < h - 1 ? at + w : -1};
        for (int k = 0; k < 4; k++) {
            const int to = next[k];
            if (to >= 0 && !c->seen[to] && f->depth_mm[to] > 0.0f &&
                fabsf(f->depth_mm[to] - f->depth_mm[at]) <= limit_mm) {
                c->seen[to] = 1;
                c->queue[tail++] = to;
            }
        }
    }
    *area_mm2 = area;
    return tail;
}

static void drop_pieces(struct iso_cleaner *c, struct bounds bounds)
{
    struct iso_frame *f = &c->frame;
    const int n = f->width_px * f->height_px;
    for (int i = 0; i < n; i++) {
        c->seen[i] = 0;
    }
    for (int i = 0; i < n; i++) {
        if (c->seen[i] || !(f->depth_mm[i] > 0.0f)) {
            continue;
        }
        double area;
        const int pixels = flood(c, i, bounds.neighbour_mm, &area);
        for (int k = 0; area < piece_mm2 && k < pixels; k++) {
            f->depth_mm[c->queue[k]] = 0.0f;
        }
    }
}

int iso_clean(struct iso_cleaner *cleaner, const struct iso_frame *frame, struct iso_vec3 centre_mm,
              double radius_mm, double pitch_mm, const struct iso_frame **out)
{
    const struct iso_window window = window_about(frame, centre_mm, radius_mm);
    const double pixel_mm = iso_camera_pixel_mm(&frame->camera, centre_mm.z);
    const int factor = (int)fmin(fmax(floor(pitch_mm / pixel_mm), 1.0), ISO_SHRINK_MAX);
    if (window.width_px < 8 * factor || window.height_px < 8 * factor) {
        return -ENODATA;
    }
    const int error = iso_frame_shrink(frame, window, factor, cleaner->capacity_px,
                                       &cleaner->frame);
    if (error) {
        return error;
    }
    const struct bounds bounds = bounds_of(&cleaner->frame);
    drop_outliers(cleaner, bounds);
    drop_pieces(cleaner, bounds);
    *out = &cleaner->frame;
    return 0;
}
