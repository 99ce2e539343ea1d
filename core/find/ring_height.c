#include "core/find/ring_height.h"

#include <math.h>
#include <stdbool.h>
#include <stddef.h>

#include "core/base/solve.h"
#include "core/frame/distortion.h"

static const double radius_mm = 40.0;
static const double reach_mm = 70.0; /* points further off in depth are not the face */
static const double low_mm = 2.0;    /* a lower mean of four points is surely no nose */

/* If all points of a ring lie on the surface, the height is at most their mean depth behind the
 * centre divided by the cosine of the angle between the line of sight and the optical axis. This
 * share of the least height allows for the rounding of pixels. */
static const double bound_share = 0.95;
/* The least cosine for which this is used where the camera distorts: 50 degrees. */
static const double cosine_distorted = 0.64;

/* The wide ring, and how far behind the place a point of it counts at least and at most. */
static const double wide_radius_mm = 90.0, behind_min_mm = -40.0, behind_max_mm = 80.0;

enum { RING = 16, RING_MIN = 9, WIDE_MIN = 5 };

/* The pixels of a ring, as steps from its centre. step[k] is radius * cos(2 pi k / RING), rounded.
 * Point k of the ring is step[k] columns to the right of the centre, and step[(k + 3 RING / 4) mod
 * RING] rows below it, because the sine is the cosine three quarters of a turn later. */
struct steps {
    int step[RING];
};

static struct steps steps_of(double radius_px)
{
    const int a = (int)lrint(radius_px), b = (int)lrint(0.92387953 * radius_px);
    const int c = (int)lrint(0.70710678 * radius_px), d = (int)lrint(0.38268343 * radius_px);
    return (struct steps){{a, b, c, d, 0, -d, -c, -b, -a, -b, -c, -d, 0, d, c, b}};
}

/* Whether a ring of this many pixels lies within the frame. */
static bool is_inside(const struct iso_frame *frame, int column, int row, int reach_px)
{
    return column >= reach_px && row >= reach_px && column + reach_px < frame->width_px &&
           row + reach_px < frame->height_px;
}

/* Whether four points of a ring of reach_px pixels, two opposite pairs, all lie on the surface, and
 * their mean is low. The ring lies within the frame. */
static bool four_are_low(const struct iso_frame *frame, int column, int row, double z_mm,
                         int reach_px)
{
    const float *at = &frame->depth_mm[(size_t)row * (size_t)frame->width_px + (size_t)column];
    const ptrdiff_t down = (ptrdiff_t)reach_px * frame->width_px;
    const double left = (double)at[-reach_px], right = (double)at[reach_px];
    const double above = (double)at[-down], below = (double)at[down];
    return left > 0.0 && right > 0.0 && above > 0.0 && below > 0.0 &&
           fabs(left - z_mm) <= reach_mm && fabs(right - z_mm) <= reach_mm &&
           fabs(above - z_mm) <= reach_mm && fabs(below - z_mm) <= reach_mm &&
           (left + right + above + below) / 4.0 - z_mm < low_mm;
}

/* Whether the points of the ring all lie on the surface, and their mean is less than below_mm
 * behind the centre. The ring lies within the frame. */
static bool all_are_low(const struct iso_frame *frame, int column, int row, double z_mm,
                        const struct steps *steps, double below_mm)
{
    double sum = 0.0;
    for (int k = 0; k < RING; k++) {
        const int down = steps->step[(k + 3 * RING / 4) % RING];
        const double z = (double)iso_frame_depth_at(frame, column + steps->step[k], row + down);
        if (!(z > 0.0) || fabs(z - z_mm) > reach_mm) {
            return false;
        }
        sum += z;
    }
    return sum / RING - z_mm < below_mm;
}

/* If all points of the ring lie on the surface and their mean depth behind the centre is less than
 * this, then the height is less than ISO_RING_HEIGHT_MIN_MM. */
static double mean_bound(const struct iso_frame *frame, int column, int row)
{
    const struct iso_camera *c = &frame->camera;
    double cosine = 1.0;
    if (c->projection == ISO_PINHOLE && iso_camera_is_distorted(c)) {
        cosine = cosine_distorted;
    } else if (c->projection == ISO_PINHOLE) {
        const double x = (column + frame->crop_x_px - c->cx_px) / c->fx_px;
        const double y = (row + frame->crop_y_px - c->cy_px) / c->fy_px;
        cosine = 1.0 / sqrt(1.0 + x * x + y * y);
    }
    return bound_share * ISO_RING_HEIGHT_MIN_MM * cosine;
}

/* The points of a ring that lie on the surface. */
struct ring {
    int n, column[RING], row[RING];
};

static void collect_ring(const struct iso_frame *frame, int column, int row, double z_mm,
                         const struct steps *steps, struct ring *ring)
{
    ring->n = 0;
    for (int k = 0; k < RING; k++) {
        const int u = column + steps->step[k], v = row + steps->step[(k + 3 * RING / 4) % RING];
        if (u < 0 || v < 0 || u >= frame->width_px || v >= frame->height_px) {
            continue;
        }
        const double z = (double)iso_frame_depth_at(frame, u, v);
        if (z > 0.0 && fabs(z - z_mm) <= reach_mm) {
            ring->column[ring->n] = u;
            ring->row[ring->n++] = v;
        }
    }
}

/* Height of a place towards the camera, above the least-squares plane z = a + b dx + c dy through a
 * ring about it, along the normal of the plane. */
static double height_above_plane(const struct iso_frame *frame, const struct ring *ring,
                                 struct iso_vec3 centre)
{
    double x = 0.0, y = 0.0, xx = 0.0, xy = 0.0, yy = 0.0, z = 0.0, xz = 0.0, yz = 0.0;
    for (int k = 0; k < ring->n; k++) {
        const struct iso_vec3 point = iso_frame_point_quick(frame, ring->column[k], ring->row[k]);
        const struct iso_vec3 d = iso_sub(point, centre);
        x += d.x;
        y += d.y;
        xx += d.x * d.x;
        xy += d.y * d.x;
        yy += d.y * d.y;
        z += d.z;
        xz += d.x * d.z;
        yz += d.y * d.z;
    }
    double normal[9] = {ring->n, 0.0, 0.0, x, xx, 0.0, y, xy, yy}, right[3] = {z, xz, yz};
    if (iso_cholesky_factorise(normal, 3)) {
        return 0.0;
    }
    iso_cholesky_solve(normal, 3, right);
    return right[0] / sqrt(1.0 + right[1] * right[1] + right[2] * right[2]);
}

double iso_ring_height(const struct iso_frame *frame, int column, int row, double z_mm)
{
    const double radius_px = radius_mm / iso_camera_pixel_mm(&frame->camera, z_mm);
    const int reach_px = (int)lrint(radius_px);
    const bool inside = is_inside(frame, column, row, reach_px);
    if (inside && four_are_low(frame, column, row, z_mm, reach_px)) {
        return 0.0; /* as most pixels */
    }
    const struct steps steps = steps_of(radius_px);
    struct ring ring;
    if (inside && all_are_low(frame, column, row, z_mm, &steps, mean_bound(frame, column, row))) {
        return 0.0;
    }
    collect_ring(frame, column, row, z_mm, &steps, &ring);
    if (ring.n < RING_MIN) {
        return 0.0;
    }
    const struct iso_vec3 centre = iso_camera_back_project(
        &frame->camera, column + frame->crop_x_px, row + frame->crop_y_px, z_mm);
    return height_above_plane(frame, &ring, centre);
}

double iso_ring_stands_out(const struct iso_frame *frame, int column, int row, double z_mm)
{
    const struct steps steps = steps_of(wide_radius_mm / iso_camera_pixel_mm(&frame->camera, z_mm));
    double sum_mm = 0.0;
    int n = 0;
    for (int k = 0; k < RING; k++) {
        const int u = column + steps.step[k], v = row + steps.step[(k + 3 * RING / 4) % RING];
        if (u >= 0 && v >= 0 && u < frame->width_px && v < frame->height_px) {
            const double z = (double)iso_frame_depth_at(frame, u, v);
            sum_mm += z > 0.0 ? fmin(fmax(z - z_mm, behind_min_mm), behind_max_mm) : behind_max_mm;
            n++;
        }
    }
    return n < WIDE_MIN ? behind_max_mm : sum_mm / n;
}
