#include "core/surface/resample.h"

#include <math.h>
#include <string.h>

#include "core/frame/depth_lanes.h"
#include "core/frame/distortion.h"
#include "core/surface/cell.h"
#include "core/surface/face_patch.h"

/* The frame is worked on in columns of CELLS cells. A row of such a column has CELLS + 1 corners,
 * and is computed ISO_DEPTHS corners at a time. */
enum { CELLS = 64, CORNERS = CELLS + ISO_DEPTHS };

/* Triangles nearer to the view than this are left out. */
static const double near_mm = 1.0;

/* Where the corners of one row of a column appear in the view, pixels of the view. */
struct row {
    float u_px[CORNERS], v_px[CORNERS];
};

struct resampling {
    const struct iso_frame *frame;
    const struct iso_raster *view;
    const struct iso_rigid *face_from_camera;
    double jump_mm;
    bool plain;           /* a pinhole camera without distortion */
    float margin_px;      /* more than the rounding errors of struct row */
    int column;           /* of the first cell of the column */
    int corners;          /* of a row of the column: cells + 1 */
    float slope[CORNERS]; /* x / z of the corners; only of a plain camera */
};

/* The largest depth of a frame, mm. */
static float largest_depth(const struct iso_frame *frame)
{
    const size_t n = (size_t)frame->width_px * (size_t)frame->height_px;
    const size_t n_lanes = n - n % ISO_DEPTHS;
    iso_depths most = {0};
    for (size_t i = 0; i < n_lanes; i += ISO_DEPTHS) {
        const iso_depths z = ISO_DEPTHS_LOAD(&frame->depth_mm[i]);
        most = ISO_DEPTHS_MAX(most, z);
    }
    float largest = fmaxf(fmaxf(most[0], most[1]), fmaxf(most[2], most[3]));
    for (size_t i = n_lanes; i < n; i++) {
        largest = fmaxf(largest, frame->depth_mm[i]);
    }
    return largest;
}

/* A bound of the rounding errors of struct row. A position is a depth times a factor, plus an
 * offset, and each of its six roundings errs by 2^-24 of the terms. */
static double margin_of(const struct resampling *r)
{
    const struct iso_camera *camera = &r->frame->camera;
    double x = 0.0, y = 0.0; /* the largest slopes, or the largest coordinates */
    for (int k = 0; k < 4; k++) {
        const struct iso_vec3 corner = iso_camera_back_project(camera, k & 1 ? camera->width_px : 0,
                                                               k & 2 ? camera->height_px : 0, 1.0);
        x = fmax(x, fabs(corner.x));
        y = fmax(y, fabs(corner.y));
    }
    const double depth_mm = (double)largest_depth(r->frame);
    const double reach_mm = r->plain ? depth_mm * (x + y + 1.0) : x + y + depth_mm;
    const struct iso_vec3 offset = r->face_from_camera->translation_mm;
    const double terms_px = (reach_mm + fabs(offset.x) + fabs(offset.y)) /
                                r->view->camera.pitch_mm +
                            fabs(r->view->camera.cx_px) + fabs(r->view->camera.cy_px);
    return 8.0 * terms_px * 0x1p-24;
}

/* Where x = y = 0 of the view is, pixels of its planes. */
static double view_u(const struct resampling *r)
{
    return r->view->camera.cx_px - r->view->crop_x_px;
}

static double view_v(const struct resampling *r)
{
    return r->view->camera.cy_px - r->view->crop_y_px;
}

/* A point of the frame's camera in the frame of the view. */
static struct iso_vec3 in_view(const struct resampling *r, struct iso_vec3 point)
{
    return iso_patch_from_face(iso_rigid_apply(r->face_from_camera, point));
}

/* Positions of a row of corners, by a plain camera: u = z (a x/z + b y/z + c) + d. */
static void place_plain_row(const struct resampling *r, int row, struct row *out)
{
    const struct iso_frame *frame = r->frame;
    const struct iso_camera *camera = &frame->camera;
    const double u_scale = 1.0 / r->view->camera.pitch_mm, v_scale = -u_scale; /* y is upwards */
    const struct iso_mat3 *turn = &r->face_from_camera->rotation;
    const struct iso_vec3 shift = r->face_from_camera->translation_mm;
    const double slope = (row + frame->crop_y_px - camera->cy_px) / camera->fy_px;
    const float u_x = (float)(u_scale * turn->m[0][0]), v_x = (float)(v_scale * turn->m[1][0]);
    const float u_1 = (float)(u_scale * (turn->m[0][1] * slope + turn->m[0][2]));
    const float v_1 = (float)(v_scale * (turn->m[1][1] * slope + turn->m[1][2]));
    const float u_0 = (float)(view_u(r) + u_scale * shift.x);
    const float v_0 = (float)(view_v(r) + v_scale * shift.y);
    const float *depth =
        &frame->depth_mm[(size_t)row * (size_t)frame->width_px + (size_t)r->column];
    int i = 0;
    for (; i + ISO_DEPTHS <= r->corners; i += ISO_DEPTHS) {
        const iso_depths z = ISO_DEPTHS_LOAD(&depth[i]), x = ISO_DEPTHS_LOAD(&r->slope[i]);
        ISO_DEPTHS_STORE(&out->u_px[i], z * (u_x * x + u_1) + u_0);
        ISO_DEPTHS_STORE(&out->v_px[i], z * (v_x * x + v_1) + v_0);
    }
    for (; i < r->corners; i++) {
        out->u_px[i] = depth[i] * (u_x * r->slope[i] + u_1) + u_0;
        out->v_px[i] = depth[i] * (v_x * r->slope[i] + v_1) + v_0;
    }
}

static void place_row(const struct resampling *r, int row, struct row *out)
{
    if (r->plain) {
        place_plain_row(r, row, out);
        return;
    }
    for (int i = 0; i < r->corners; i++) {
        const struct iso_vec3 p = in_view(r, iso_frame_point_quick(r->frame, r->column + i, row));
        out->u_px[i] = (float)(view_u(r) + p.x / r->view->camera.pitch_mm);
        out->v_px[i] = (float)(view_v(r) + p.y / r->view->camera.pitch_mm);
    }
}

/* Of four cells side by side: whether the corners leave room for a whole number between the least
 * and the largest coordinate. Numbers beyond the view may be said to be there. */
static iso_depth_counts encloses_whole(const float *upper, const float *lower, float margin,
                                       float last)
{
    const iso_depths a = ISO_DEPTHS_LOAD(upper), b = ISO_DEPTHS_LOAD(upper + 1);
    const iso_depths c = ISO_DEPTHS_LOAD(lower), d = ISO_DEPTHS_LOAD(lower + 1);
    const iso_depths ab_low = ISO_DEPTHS_MIN(a, b), cd_low = ISO_DEPTHS_MIN(c, d);
    const iso_depths ab_high = ISO_DEPTHS_MAX(a, b), cd_high = ISO_DEPTHS_MAX(c, d);
    const iso_depths low = ISO_DEPTHS_MIN(ab_low, cd_low) - margin;
    const iso_depths end = {last, last, last, last};
    const iso_depths reach = ISO_DEPTHS_MAX(ab_high, cd_high) + margin;
    const iso_depths high = ISO_DEPTHS_MIN(reach, end);
    /* The whole part of a number that is not negative is the largest whole number below it. */
    const iso_depths whole = __builtin_convertvector(
        __builtin_convertvector(high, iso_depth_counts), iso_depths);
    return (high >= 0.0f) & (whole >= low);
}

/* Of four cells side by side: whether at least three corners were measured. */
static iso_depth_counts has_surface(const float *upper, const float *lower)
{
    const iso_depth_counts measured = (ISO_DEPTHS_LOAD(upper) > 0.0f) +
                                      (ISO_DEPTHS_LOAD(upper + 1) > 0.0f) +
                                      (ISO_DEPTHS_LOAD(lower) > 0.0f) +
                                      (ISO_DEPTHS_LOAD(lower + 1) > 0.0f);
    return measured <= -3; /* a comparison that is true counts as -1 */
}

static double squared_distance(struct iso_vec3 a, struct iso_vec3 b)
{
    const struct iso_vec3 d = iso_sub(a, b);
    return iso_dot(d, d);
}

/* Draws the triangles of the cell whose upper left corner is at (column, row). */
static void draw_cell(const struct resampling *r, int column, int row)
{
    const struct iso_frame *frame = r->frame;
    const float *at = &frame->depth_mm[(size_t)row * (size_t)frame->width_px + (size_t)column];
    const float z[4] = {at[0], at[1], at[frame->width_px], at[frame->width_px + 1]};
    const int measured = (z[0] > 0) + (z[1] > 0) + (z[2] > 0) + (z[3] > 0);
    if (measured < 3) {
        return;
    }
    struct iso_vec3 point[4];
    for (int k = 0; k < 4; k++) {
        point[k] = iso_frame_point_quick(frame, column + (k & 1), row + (k >> 1));
    }
    const bool rising = measured == 4 &&
                        squared_distance(point[1], point[2]) < squared_distance(point[0], point[3]);
    const struct iso_cell_list list = iso_cell_list(iso_cell_set(z, rising, r->jump_mm));
    for (int k = 0; k < 4; k++) {
        point[k] = in_view(r, point[k]);
    }
    for (int h = 0; h < list.count; h++) {
        const uint8_t *corner = iso_cell_corners[list.left_out[h]];
        const struct iso_vec3 corners_mm[3] = {point[corner[0]], point[corner[1]],
                                               point[corner[2]]};
        iso_raster_triangle(r->view, corners_mm, 0, near_mm, 1);
    }
}

/* Draws the cells between two rows of corners that may cover the centre of a pixel. */
static void draw_row(const struct resampling *r, int row, const struct row *upper,
                     const struct row *lower)
{
    const struct iso_frame *frame = r->frame;
    const float *above =
        &frame->depth_mm[(size_t)row * (size_t)frame->width_px + (size_t)r->column];
    const float *below = above + frame->width_px;
    const float right = (float)(r->view->width_px - 1), bottom = (float)(r->view->height_px - 1);
    int i = 0;
    for (; i + ISO_DEPTHS < r->corners; i += ISO_DEPTHS) {
        const iso_depth_counts may = has_surface(&above[i], &below[i]) &
                                     encloses_whole(&upper->u_px[i], &lower->u_px[i], r->margin_px,
                                                    right) &
                                     encloses_whole(&upper->v_px[i], &lower->v_px[i], r->margin_px,
                                                    bottom);
        for (int k = 0; k < ISO_DEPTHS; k++) {
            if (may[k]) {
                draw_cell(r, r->column + i + k, row);
            }
        }
    }
    for (; i + 1 < r->corners; i++) {
        draw_cell(r, r->column + i, row);
    }
}

void iso_resample(const struct iso_frame *frame, double jump_mm,
                  const struct iso_rigid *face_from_camera, const struct iso_raster *view)
{
    const struct iso_camera *camera = &frame->camera;
    struct resampling r = {
        .frame = frame,
        .view = view,
        .face_from_camera = face_from_camera,
        .jump_mm = jump_mm,
        .plain = camera->projection == ISO_PINHOLE && !iso_camera_is_distorted(camera),
    };
    r.margin_px = (float)margin_of(&r);
    struct row rows[2];
    for (r.column = 0; r.column + 1 < frame->width_px; r.column += CELLS) {
        const int left = frame->width_px - r.column;
        r.corners = left < CELLS + 1 ? left : CELLS + 1;
        for (int i = 0; r.plain && i < r.corners; i++) {
            r.slope[i] = (float)((r.column + i + frame->crop_x_px - camera->cx_px) / camera->fx_px);
        }
        place_row(&r, 0, &rows[0]);
        for (int row = 0; row + 1 < frame->height_px; row++) {
            place_row(&r, row + 1, &rows[(row + 1) % 2]);
            draw_row(&r, row, &rows[row % 2], &rows[(row + 1) % 2]);
        }
    }
}
