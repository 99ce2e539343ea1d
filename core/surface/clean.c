#include "core/surface/clean.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/frame/depth_step.h"
#include "core/frame/shrink.h"
#include "core/surface/agreeing.h"

/* Two bounds on differences in depth. Both are raised to bound_steps times the step of the depths
 * (depth_step.h) if this is more, so that a pixel may differ by one step, but not by two. */
static const float neighbour_mm = 8.0f;
static const float median_mm = 6.0f;
static const double bound_steps = 1.25;
static const double piece_mm2 = 3000.0;

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
        c->frame.depth_mm = calloc(capacity_px + ISO_AGREEING_SLACK, sizeof *c->frame.depth_mm);
        c->kept = calloc(capacity_px + ISO_AGREEING_SLACK, sizeof *c->kept);
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
                explicit_bzero(planes[i],
                               (cleaner->capacity_px + ISO_AGREEING_SLACK) * sizeof *planes[i]);
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

static struct iso_agreeing_bounds bounds_of(const struct iso_frame *frame)
{
    const float coarse_mm = (float)(bound_steps * iso_depth_step(frame));
    return (struct iso_agreeing_bounds){fmaxf(neighbour_mm, coarse_mm),
                                        fmaxf(median_mm, coarse_mm)};
}

/* The kept pixels become those that agree with their surroundings; none at the border. */
static void drop_outliers(struct iso_cleaner *c, struct iso_agreeing_bounds bounds)
{
    struct iso_frame *f = &c->frame;
    iso_keep_agreeing(f->depth_mm, f->width_px, f->height_px, bounds, c->kept);
    float *swap = f->depth_mm;
    f->depth_mm = c->kept;
    c->kept = swap;
}

/* Flood fill from a seed. The pixels stay in the queue. Returns their number and their area. No
 * measured pixel lies at the border, so that each has four neighbours. */
static int flood(struct iso_cleaner *c, int seed, float limit_mm, double *area_mm2)
{
    const struct iso_frame *f = &c->frame;
    const int w = f->width_px, next[4] = {-1, 1, -w, w};
    int head = 0, tail = 0;
    double area = 0.0;
    c->queue[tail++] = seed;
    c->seen[seed] = 1;
    while (head < tail) {
        const int at = c->queue[head++];
        const double pixel = iso_camera_pixel_mm(&f->camera, (double)f->depth_mm[at]);
        area += pixel * pixel;
        for (int k = 0; k < 4; k++) {
            const int to = at + next[k];
            if (!c->seen[to] && f->depth_mm[to] > 0.0f &&
                fabsf(f->depth_mm[to] - f->depth_mm[at]) <= limit_mm) {
                c->seen[to] = 1;
                c->queue[tail++] = to;
            }
        }
    }
    *area_mm2 = area;
    return tail;
}

static void drop_pieces(struct iso_cleaner *c, struct iso_agreeing_bounds bounds)
{
    struct iso_frame *f = &c->frame;
    const int n = f->width_px * f->height_px;
    memset(c->seen, 0, (size_t)n * sizeof *c->seen);
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
    const struct iso_agreeing_bounds bounds = bounds_of(&cleaner->frame);
    drop_outliers(cleaner, bounds);
    drop_pieces(cleaner, bounds);
    *out = &cleaner->frame;
    return 0;
}
