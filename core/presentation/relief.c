#include "core/presentation/relief.h"

#include <errno.h>

#include "core/frame/distortion.h"

enum { SIDE = 17, CELLS = SIDE * SIDE, CELLS_MIN = 60, PER_CELL = 9 };

static const double cell_mm = 6.0;
static const double radius_mm = 48.0;
/* Points further before or behind the origin do not belong to the face. */
static const double depth_mm = 70.0;
/* The tip of the nose is in the middle; the ring lies outside the wings of the nose. */
static const double tip_mm = 8.0, ring_mm = 30.0;

/* The sums of the points of each cell; later their means, without the cells that have no points. */
struct cells {
    struct iso_vec3 point_mm[CELLS];
    int n[CELLS];
};

/* The step between pixels that are read: several in each cell are enough. */
static int stride_of(const struct iso_frame *frame, double z_mm)
{
    const double pixel = iso_camera_pixel_mm(&frame->camera, z_mm);
    return (int)fmin(fmax(cell_mm / (PER_CELL * pixel) + 0.5, 1.0), 16.0);
}

/* floor(x + 0.5), without a call. */
static int nearest(double x)
{
    const int whole = (int)(x + 0.5);
    return whole - (whole > x + 0.5);
}

static void collect(const struct iso_frame *frame, const struct iso_rigid *camera_from_face,
                    struct cells *cells)
{
    const struct iso_rigid face_from_camera = iso_rigid_inverse(camera_from_face);
    const struct iso_vec3 middle = camera_from_face->translation_mm;
    double u, v;
    if (!iso_camera_project(&frame->camera, middle, &u, &v)) {
        return;
    }
    const int stride = stride_of(frame, middle.z);
    const double reach = 1.2 * radius_mm / iso_camera_pixel_mm(&frame->camera, middle.z);
    u -= frame->crop_x_px;
    v -= frame->crop_y_px;
    int left = (int)fmax(u - reach, 0.0), right = (int)fmin(u + reach, frame->width_px - 1.0);
    int top = (int)fmax(v - reach, 0.0), bottom = (int)fmin(v + reach, frame->height_px - 1.0);
    for (int row = top; row <= bottom; row += stride) {
        for (int column = left; column <= right; column += stride) {
            if (!(iso_frame_depth_at(frame, column, row) > 0.0f)) {
                continue;
            }
            const struct iso_vec3 p = iso_rigid_apply(&face_from_camera,
                                                      iso_frame_point_quick(frame, column, row));
            if (p.x * p.x + p.y * p.y > radius_mm * radius_mm || fabs(p.z) > depth_mm) {
                continue;
            }
            const int i = nearest(p.x / cell_mm) + SIDE / 2, j = nearest(p.y / cell_mm) + SIDE / 2;
            const int cell = j * SIDE + i;
            cells->point_mm[cell] = iso_add(cells->point_mm[cell], p);
            cells->n[cell]++;
        }
    }
}

int iso_relief_measure(const struct iso_frame *frame, const struct iso_rigid *camera_from_face,
                       struct iso_relief *out)
{
    struct cells cells = {.n = {0}};
    struct iso_vec3 *points = cells.point_mm, ring[CELLS];
    struct iso_vec3 tip = {0, 0, 0};
    int n = 0, n_ring = 0, n_tip = 0;
    collect(frame, camera_from_face, &cells);
    for (int i = 0; i < CELLS; i++) {
        if (cells.n[i] == 0) {
            continue;
        }
        const struct iso_vec3 p = iso_scale(1.0 / cells.n[i], cells.point_mm[i]);
        const double r = hypot(p.x, p.y);
        points[n++] = p; /* n <= i */
        if (r > ring_mm) {
            ring[n_ring++] = p;
        } else if (r < tip_mm) {
            tip = iso_add(tip, p);
            n_tip++;
        }
    }
    if (n < CELLS_MIN) {
        return -ENODATA;
    }
    struct iso_relief relief = {.n_cells = n};
    struct iso_sheet_fit beside;
    double plane[3];
    int error = iso_plane_fit(ring, n_ring, ISO_RELIEF_LIMIT_MM, plane, &beside);
    if (!error) {
        relief.nose_mm = n_tip > 0 ? iso_above_plane(plane, iso_scale(1.0 / n_tip, tip)) : 0.0;
        error = iso_plane_fit(points, n, ISO_RELIEF_LIMIT_MM, plane, &relief.flat);
    }
    if (!error) {
        error = iso_bent_sheet_fit(points, n, ISO_RELIEF_LIMIT_MM, &relief.bent);
    }
    if (error) {
        return error;
    }
    *out = relief;
    return 0;
}
