#include "core/find/ring_height.h"

#include <math.h>
#include <stdbool.h>
#include <stddef.h>

#include "core/base/lanes.h"

/* Two depths of a plane. */
#define TWO_AT(p) ((iso_pair){(double)(p)[0], (double)(p)[1]})

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

/* Whether a ring of this many pixels lies within the frame. A radius that no int holds may have
 * become negative. */
static bool is_inside(const struct iso_frame *frame, int column, int row, int reach_px)
{
    return reach_px >= 0 && column >= reach_px && row >= reach_px &&
           column + reach_px < frame->width_px && row + reach_px < frame->height_px;
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

/* If all points of the ring lie on the surface and their mean depth behind the centre is less than
 * this, then the height is less than ISO_RING_HEIGHT_MIN_MM. */
static double mean_bound(const struct iso_frame *frame, const struct iso_sight_lines *lines,
                         int column, int row)
{
    const struct iso_camera *c = &frame->camera;
    double cosine = 1.0;
    if (c->projection == ISO_PINHOLE && !lines->column) {
        cosine = cosine_distorted;
    } else if (c->projection == ISO_PINHOLE) {
        const double x = lines->column[column], y = lines->row[row];
        cosine = 1.0 / sqrt(1.0 + x * x + y * y);
    }
    return bound_share * ISO_RING_HEIGHT_MIN_MM * cosine;
}

/* Whether the points of the ring all lie on the surface, and their mean is less than the bound
 * behind the centre. The ring lies within the frame. */
static bool all_are_low(const struct iso_frame *frame, const struct iso_sight_lines *lines,
                        int column, int row, double z_mm, const struct steps *steps)
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
    return sum / RING - z_mm < mean_bound(frame, lines, column, row);
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

/* Solves A x = b for a symmetric matrix A of three rows, of which a has the lower triangle row by
 * row: iso_cholesky_factorise() and iso_cholesky_solve() without loops. Returns false where
 * these refuse A. */
static bool solve_three(const double a[6], double b[3])
{
    enum { A00, A10, A11, A20, A21, A22 };
    static const double least_share = 1e-12;
    if (!(a[A00] > least_share * fabs(a[A00]))) {
        return false;
    }
    const double l00 = sqrt(a[A00]), l10 = a[A10] / l00, l20 = a[A20] / l00;
    const double second = a[A11] - l10 * l10;
    if (!(second > least_share * fabs(second + l10 * l10))) {
        return false;
    }
    const double l11 = sqrt(second), l21 = (a[A21] - l20 * l10) / l11;
    const double third = a[A22] - l20 * l20 - l21 * l21;
    if (!(third > least_share * fabs(third + (l20 * l20 + l21 * l21)))) {
        return false;
    }
    const double l22 = sqrt(third);
    const double y0 = b[0] / l00, y1 = (b[1] - l10 * y0) / l11;
    const double y2 = (b[2] - l20 * y0 - l21 * y1) / l22;
    b[2] = y2 / l22;
    b[1] = (y1 - l21 * b[2]) / l11;
    b[0] = (y0 - l10 * b[1] - l20 * b[2]) / l00;
    return true;
}

/* As iso_frame_point_at(). */
static struct iso_vec3 point_at(const struct iso_frame *frame, const struct iso_sight_lines *lines,
                                int column, int row)
{
    if (!lines->column) {
        return iso_frame_point_at(frame, column, row);
    }
    const double z = (double)iso_frame_depth_at(frame, column, row);
    return iso_vec3(lines->column[column] * z, lines->row[row] * z, z);
}

/* Height of a place towards the camera, above the least-squares plane z = a + b dx + c dy through a
 * ring about it, along the normal of the plane. */
static double height_above_plane(const struct iso_frame *frame, const struct iso_sight_lines *lines,
                                 const struct ring *ring, struct iso_vec3 centre)
{
    double x = 0.0, y = 0.0, xx = 0.0, xy = 0.0, yy = 0.0, z = 0.0, xz = 0.0, yz = 0.0;
    for (int k = 0; k < ring->n; k++) {
        const struct iso_vec3 d = iso_sub(point_at(frame, lines, ring->column[k], ring->row[k]),
                                          centre);
        x += d.x;
        y += d.y;
        xx += d.x * d.x;
        xy += d.y * d.x;
        yy += d.y * d.y;
        z += d.z;
        xz += d.x * d.z;
        yz += d.y * d.z;
    }
    const double normal[6] = {ring->n, x, xx, y, xy, yy};
    double right[3] = {z, xz, yz};
    if (!solve_three(normal, right)) {
        return 0.0;
    }
    return right[0] / sqrt(1.0 + right[1] * right[1] + right[2] * right[2]);
}

unsigned iso_rings_are_low(const struct iso_frame *frame, int column, int row,
                           const double z_mm[ISO_RINGS])
{
    int reach_px[ISO_RINGS];
    for (int k = 0; k < ISO_RINGS; k += ISO_PAIR) { /* as iso_ring_height() rounds */
        iso_pair pixel_mm = ISO_PAIR_LOAD(&z_mm[k]) / frame->camera.fx_px;
        if (frame->camera.projection != ISO_PINHOLE) {
            pixel_mm = (iso_pair){frame->camera.pitch_mm, frame->camera.pitch_mm};
        }
        const iso_pair radius_px = radius_mm / pixel_mm;
        reach_px[k] = (int)lrint(radius_px[0]);
        reach_px[k + 1] = (int)lrint(radius_px[1]);
    }
    const int reach = reach_px[0];
    if (reach_px[1] != reach || reach_px[2] != reach || reach_px[3] != reach ||
        !is_inside(frame, column, row, reach) ||
        !is_inside(frame, column + ISO_RINGS - 1, row, reach)) {
        return 0;
    }
    const float *at = &frame->depth_mm[(size_t)row * (size_t)frame->width_px + (size_t)column];
    const ptrdiff_t down = (ptrdiff_t)reach * frame->width_px;
    iso_pair_bits low[ISO_RINGS / ISO_PAIR];
    for (int k = 0; k < ISO_RINGS; k += ISO_PAIR) {
        const iso_pair z = ISO_PAIR_LOAD(&z_mm[k]);
        const iso_pair points[4] = {TWO_AT(at + k - reach), TWO_AT(at + k + reach),
                                    TWO_AT(at + k - down), TWO_AT(at + k + down)};
        iso_pair_bits on = ~(iso_pair_bits){0};
        for (int i = 0; i < 4; i++) {
            const iso_pair behind = points[i] - z;
            on &= (points[i] > 0.0) & (behind <= reach_mm) & (behind >= -reach_mm);
        }
        const iso_pair sum = points[0] + points[1] + points[2] + points[3];
        low[k / ISO_PAIR] = on & (sum / 4.0 - z < low_mm);
    }
    return (unsigned)((low[0][0] & 1) | (low[0][1] & 2) | (low[1][0] & 4) | (low[1][1] & 8));
}

double iso_ring_height(const struct iso_frame *frame, const struct iso_sight_lines *lines,
                       int column, int row, double z_mm)
{
    const double radius_px = radius_mm / iso_camera_pixel_mm(&frame->camera, z_mm);
    const int reach_px = (int)lrint(radius_px);
    const bool inside = is_inside(frame, column, row, reach_px);
    if (inside && four_are_low(frame, column, row, z_mm, reach_px)) {
        return 0.0; /* as most pixels */
    }
    const struct steps steps = steps_of(radius_px);
    struct ring ring;
    if (inside && all_are_low(frame, lines, column, row, z_mm, &steps)) {
        return 0.0;
    }
    collect_ring(frame, column, row, z_mm, &steps, &ring);
    if (ring.n < RING_MIN) {
        return 0.0;
    }
    const struct iso_vec3 centre = iso_camera_back_project(
        &frame->camera, column + frame->crop_x_px, row + frame->crop_y_px, z_mm);
    return height_above_plane(frame, lines, &ring, centre);
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
