#include "core/surface/face_patch.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/wipe.h"
#include "core/surface/fill.h"
#include "core/surface/raster.h"
#include "core/surface/resample.h"

/* Where the mean face is steeper than this (change of depth over distance), the patch ends: a view
 * from the front shows little of such places. */
static const float slope_max = 3.0f;

struct iso_face_patch {
    struct iso_face_patch_options options;
    int side; /* columns and rows; odd, the nose tip in the middle */
    struct iso_frame frame;
    float *mean_depth; /* of the mean face; 0 outside the domain */
    float *residual;   /* measured minus mean */
    uint8_t *domain;   /* 1 inside */
    uint8_t *measured; /* 1 where the residual was measured */
    struct iso_fill *fill;
};

static size_t count_pixels(const struct iso_face_patch *patch)
{
    return (size_t)patch->side * (size_t)patch->side;
}

static struct iso_raster raster_of(const struct iso_face_patch *patch)
{
    return (struct iso_raster){
        .camera = patch->frame.camera,
        .width_px = patch->side,
        .height_px = patch->side,
        .depth_mm = patch->frame.depth_mm,
    };
}

static bool too_steep(const struct iso_face_patch *patch, int column, int row)
{
    const float *z = patch->frame.depth_mm;
    const float limit = slope_max * (float)patch->options.spacing_mm;
    const float at = z[row * patch->side + column];
    for (int k = 0; k < 4; k++) {
        int u = column + (k == 0) - (k == 1), v = row + (k == 2) - (k == 3);
        if (u < 0 || v < 0 || u >= patch->side || v >= patch->side) {
            continue;
        }
        const float near = z[v * patch->side + u];
        if (!(near > 0.0f) || fabsf(near - at) > limit) {
            return true;
        }
    }
    return false;
}

/* Spreads a mark from pixels that carry it to their four neighbours whose domain is `over`, until
 * there is no such neighbour left. */
static void spread_mark(struct iso_face_patch *patch, uint8_t over, uint8_t mark)
{
    const int side = patch->side;
    uint8_t *d = patch->domain;
    for (bool grown = true; grown;) {
        grown = false;
        for (int i = side; i < side * (side - 1); i++) {
            bool beside = ((d[i - 1] | d[i + 1] | d[i - side] | d[i + side]) & mark) != 0;
            if (d[i] == over && beside) {
                d[i] |= mark;
                grown = true;
            }
        }
    }
}

/* Makes the domain one piece without holes: all pixels that are connected with the nose tip, and
 * the steep places that they enclose (the sides of the nose). The outermost rows and columns are
 * never part of it. */
static void make_whole(struct iso_face_patch *patch)
{
    enum { INSIDE = 1, JOINED = 2, OUTSIDE = 4 };
    int side = patch->side, n = side * side;
    uint8_t *d = patch->domain;
    d[n / 2] = INSIDE | JOINED;
    spread_mark(patch, INSIDE, JOINED);
    for (int i = 0; i < n; i++) {
        const bool border = i < side || i >= n - side || i % side == 0 || i % side == side - 1;
        if (d[i] & JOINED) {
            d[i] = INSIDE;
        } else {
            d[i] = border ? OUTSIDE : 0;
        }
    }
    spread_mark(patch, 0, OUTSIDE);
    for (int i = 0; i < n; i++) {
        d[i] = !(d[i] & OUTSIDE) && patch->mean_depth[i] > 0.0f;
        patch->mean_depth[i] = d[i] ? patch->mean_depth[i] : 0.0f;
    }
}

/* Draws the mean face once and decides where the patch has values. */
static int draw_mean(struct iso_face_patch *patch, const struct iso_head_model *model)
{
    struct iso_vec3 *vertices = calloc(model->n_vertices, sizeof *vertices);
    if (!vertices) {
        return -ENOMEM;
    }
    for (uint32_t i = 0; i < model->n_vertices; i++) {
        vertices[i] = iso_patch_from_face(model->mean_mm[i]);
    }
    struct iso_raster raster = raster_of(patch);
    iso_raster_clear(&raster);
    iso_raster_triangles(&raster, vertices, (const uint32_t(*)[3])model->triangles,
                         (int32_t)model->n_triangles, 0, 1.0, 1);
    free(vertices);

    const double middle = (patch->side - 1) / 2.0;
    for (int row = 0; row < patch->side; row++) {
        for (int column = 0; column < patch->side; column++) {
            const int i = row * patch->side + column;
            double off_mm = patch->options.spacing_mm * hypot(column - middle, row - middle);
            const float z = patch->frame.depth_mm[i];
            patch->domain[i] = z > 0.0f && off_mm <= patch->options.radius_mm &&
                               !too_steep(patch, column, row);
            patch->mean_depth[i] = z;
        }
    }
    make_whole(patch);
    return 0;
}

static bool options_sane(const struct iso_face_patch_options *o)
{
    return o->radius_mm >= 40.0 && o->radius_mm <= 150.0 && o->spacing_mm >= 0.5 &&
           o->spacing_mm <= 8.0 && o->smoothing_mm >= 0.0 && o->smoothing_mm <= 20.0 &&
           o->outlier_mm > 0.0;
}

int iso_face_patch_new(const struct iso_head_model *model,
                       const struct iso_face_patch_options *options, struct iso_face_patch **out)
{
    if (!options_sane(options)) {
        return -EINVAL;
    }
    struct iso_face_patch *p = calloc(1, sizeof *p);
    if (!p) {
        return -ENOMEM;
    }
    const int half = (int)ceil(options->radius_mm / options->spacing_mm) + 1;
    p->options = *options;
    p->side = 2 * half + 1;
    p->frame.camera = (struct iso_camera){
        .projection = ISO_ORTHOGRAPHIC,
        .width_px = p->side,
        .height_px = p->side,
        .pitch_mm = options->spacing_mm,
        .cx_px = half,
        .cy_px = half,
    };
    p->frame.width_px = p->frame.height_px = p->side;
    p->frame.depth_mm = calloc(count_pixels(p), sizeof(float));
    p->mean_depth = calloc(count_pixels(p), sizeof(float));
    p->residual = calloc(count_pixels(p), sizeof(float));
    p->domain = calloc(count_pixels(p), 1);
    p->measured = calloc(count_pixels(p), 1);
    int error = -ENOMEM;
    if (p->frame.depth_mm && p->mean_depth && p->residual && p->domain && p->measured) {
        error = draw_mean(p, model);
    }
    if (!error) {
        error = iso_fill_new(p->side, p->side, p->domain,
                             options->smoothing_mm / options->spacing_mm, &p->fill);
    }
    if (error) {
        iso_face_patch_free(p);
        return error;
    }
    *out = p;
    return 0;
}

void iso_face_patch_free(struct iso_face_patch *patch)
{
    if (patch) {
        iso_fill_free(patch->fill);
        iso_wipe_free(patch->frame.depth_mm);
        free(patch->mean_depth); /* of the model */
        iso_wipe_free(patch->residual);
        free(patch->domain);
        iso_wipe_free(patch->measured);
        free(patch);
    }
}

/* Makes the patch of the surface that was drawn. Returns the share of the domain that was measured.
 */
static double build(struct iso_face_patch *patch)
{
    float *depth = patch->frame.depth_mm;
    size_t inside = 0, measured = 0;
    for (size_t i = 0; i < count_pixels(patch); i++) {
        const float residual = depth[i] - patch->mean_depth[i];
        patch->measured[i] = patch->domain[i] && depth[i] > 0.0f &&
                             fabsf(residual) <= (float)patch->options.outlier_mm;
        patch->residual[i] = patch->measured[i] ? residual : 0.0f;
        inside += patch->domain[i];
        measured += patch->measured[i];
    }
    if (measured > 0) {
        iso_fill_holes(patch->fill, patch->measured, patch->residual);
        iso_fill_smooth(patch->fill, patch->residual);
    }
    for (size_t i = 0; i < count_pixels(patch); i++) {
        depth[i] = patch->domain[i] ? patch->mean_depth[i] + patch->residual[i] : 0.0f;
    }
    return inside > 0 ? (double)measured / (double)inside : 0.0;
}

double iso_face_patch_build(struct iso_face_patch *patch, struct iso_mesh *surface,
                            const struct iso_rigid *camera_from_face)
{
    const struct iso_rigid face_from_camera = iso_rigid_inverse(camera_from_face);
    for (int32_t i = 0; i < surface->n_vertices; i++) {
        const struct iso_vec3 face = iso_rigid_apply(&face_from_camera, surface->vertices_mm[i]);
        surface->vertices_mm[i] = iso_patch_from_face(face);
    }
    const struct iso_raster raster = raster_of(patch);
    iso_raster_clear(&raster);
    /* Indices are not negative, so that they read the same unsigned. */
    iso_raster_triangles(&raster, surface->vertices_mm, (const uint32_t(*)[3])surface->triangles,
                         surface->n_triangles, 0, 1.0, 1);
    return build(patch);
}

double iso_face_patch_resample(struct iso_face_patch *patch, const struct iso_frame *frame,
                               double jump_mm, const struct iso_rigid *camera_from_face)
{
    const struct iso_rigid face_from_camera = iso_rigid_inverse(camera_from_face);
    const struct iso_raster raster = raster_of(patch);
    iso_raster_clear(&raster);
    iso_resample(frame, jump_mm, &face_from_camera, &raster);
    return build(patch);
}

const struct iso_frame *iso_face_patch_frame(const struct iso_face_patch *patch)
{
    return &patch->frame;
}

void iso_face_patch_pixel(const struct iso_face_patch *patch, double x_mm, double y_mm,
                          double *column, double *row)
{
    const double middle = (patch->side - 1) / 2.0;
    *column = middle + x_mm / patch->options.spacing_mm;
    *row = middle - y_mm / patch->options.spacing_mm;
}

double iso_face_patch_measured(const struct iso_face_patch *patch, double x_mm, double y_mm)
{
    double column, row;
    iso_face_patch_pixel(patch, x_mm, y_mm, &column, &row);
    int u = (int)floor(column), v = (int)floor(row);
    if (u < 0 || v < 0 || u + 1 >= patch->side || v + 1 >= patch->side) {
        return 0.0;
    }
    double s = column - u, t = row - v;
    const uint8_t *m = &patch->measured[v * patch->side + u];
    return (1 - t) * ((1 - s) * m[0] + s * m[1]) +
           t * ((1 - s) * m[patch->side] + s * m[patch->side + 1]);
}
