#include "sim/train/head/head_picture.h"

#include <errno.h>
#include <limits.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include "core/surface/raster.h"
#include "drivers/file/png.h"

enum { VIEW_PX = 480, VIEWS = 2, MODES_SHOWN = 5, PIXELS = VIEW_PX * VIEW_PX };

static const double pitch_mm = 0.55, camera_distance_mm = 400.0, turn_rad = 0.87;

struct painter {
    const struct iso_head_model *model;
    struct iso_vec3 *shape_mm, *seen_mm; /* [n_vertices]: face frame, camera frame */
    float depth_mm[PIXELS], weight[PIXELS][2];
    int32_t triangle[PIXELS];
    uint8_t grey[VIEWS * PIXELS];
};

/* Lambert's law with the light above the subject's left. Facets are visible on purpose. */
static uint8_t shade_of(const struct iso_vec3 p[3])
{
    const struct iso_vec3 to_light = {0.4, -0.4, -0.82};
    struct iso_vec3 normal = iso_unit(iso_cross(iso_sub(p[1], p[0]), iso_sub(p[2], p[0])));
    const double light = iso_dot(normal, to_light);
    return (uint8_t)(50.0 + 205.0 * (light > 0.0 ? light : 0.0));
}

/* Whether a pixel is within half a pixel's width of its triangle's edge. */
static bool on_edge(const struct iso_vec3 p[3], const float weight[2])
{
    double w[3] = {1.0 - (double)(weight[0] + weight[1]), (double)weight[0], (double)weight[1]};
    const double twice_area = (p[1].x - p[0].x) * (p[2].y - p[0].y) -
                              (p[1].y - p[0].y) * (p[2].x - p[0].x);
    for (int k = 0; k < 3; k++) {
        struct iso_vec3 opposite = iso_sub(p[(k + 2) % 3], p[(k + 1) % 3]);
        const double height_mm = fabs(twice_area) / hypot(opposite.x, opposite.y);
        if (w[k] * height_mm < 0.5 * pitch_mm) {
            return true;
        }
    }
    return false;
}

static void paint_view(struct painter *painter, int view, bool edges)
{
    const struct iso_head_model *model = painter->model;
    /* The head turns about its middle, not about the nose. */
    const struct iso_vec3 middle_mm = {0.0, 5.0, -60.0};
    const struct iso_mat3 frontal = {{{1, 0, 0}, {0, -1, 0}, {0, 0, -1}}};
    struct iso_mat3 turn = iso_mat3_rotation(iso_vec3(0.0, view * turn_rad, 0.0));
    struct iso_rigid camera_from_face = {iso_mat3_mul(&frontal, &turn),
                                         {0.0, 0.0, camera_distance_mm}};
    for (uint32_t i = 0; i < model->n_vertices; i++) {
        struct iso_vec3 p = iso_sub(painter->shape_mm[i], middle_mm);
        painter->seen_mm[i] = iso_rigid_apply(&camera_from_face, p);
    }
    struct iso_raster raster = {
        .camera = {.projection = ISO_ORTHOGRAPHIC,
                   .width_px = VIEW_PX,
                   .height_px = VIEW_PX,
                   .pitch_mm = pitch_mm,
                   .cx_px = 0.5 * VIEW_PX,
                   .cy_px = 0.5 * VIEW_PX},
        .width_px = VIEW_PX,
        .height_px = VIEW_PX,
        .depth_mm = painter->depth_mm,
        .triangle = painter->triangle,
        .weight = painter->weight,
    };
    iso_raster_clear(&raster);
    iso_raster_triangles(&raster, painter->seen_mm, (const uint32_t(*)[3])model->triangles,
                         (int32_t)model->n_triangles, 0, 1.0, 1);
    for (int i = 0; i < PIXELS; i++) {
        uint8_t *pixel = &painter->grey[(i / VIEW_PX * VIEWS + view) * VIEW_PX + i % VIEW_PX];
        *pixel = 0;
        if (painter->triangle[i] >= 0) {
            const uint32_t *v = model->triangles[painter->triangle[i]];
            struct iso_vec3 p[3] = {painter->seen_mm[v[0]], painter->seen_mm[v[1]],
                                    painter->seen_mm[v[2]]};
            *pixel = edges && on_edge(p, painter->weight[i]) ? 0 : shade_of(p);
        }
    }
}

static int paint(struct painter *painter, bool edges, const char *path, struct iso_fault *fault)
{
    for (int view = 0; view < VIEWS; view++) {
        paint_view(painter, view, edges);
    }
    struct iso_image image = {.width_px = VIEWS * VIEW_PX,
                              .height_px = VIEW_PX,
                              .pixel = ISO_PIXEL_GREY8,
                              .samples = painter->grey};
    return iso_png_write(path, &image, 6, fault);
}

/* shape = mean + sigmas * mode; the mean alone if mode is NULL. */
static void set_shape(struct painter *painter, const float *mode_mm, double sigmas)
{
    for (uint32_t i = 0; i < painter->model->n_vertices; i++) {
        struct iso_vec3 p = painter->model->mean_mm[i];
        if (mode_mm) {
            const float *m = mode_mm + 3 * (size_t)i;
            p = iso_madd(p, sigmas, iso_vec3((double)m[0], (double)m[1], (double)m[2]));
        }
        painter->shape_mm[i] = p;
    }
}

static int paint_modes(struct painter *painter, const char *directory, const char *name,
                       const float *modes_mm, uint32_t n_modes, struct iso_fault *fault)
{
    char path[PATH_MAX];
    int error = 0;
    for (uint32_t k = 0; !error && k < 2 * n_modes && k < 2 * MODES_SHOWN; k++) {
        const char *side = k % 2 ? "plus" : "minus";
        (void)snprintf(path, sizeof path, "%s/%s-%u-%s.png", directory, name, k / 2 + 1, side);
        set_shape(painter, modes_mm + 3 * (size_t)(k / 2) * painter->model->n_vertices,
                  k % 2 ? 2.0 : -2.0);
        error = paint(painter, false, path, fault);
    }
    return error;
}

static int paint_all(struct painter *painter, const char *directory, struct iso_fault *fault)
{
    const struct iso_head_model *model = painter->model;
    char path[PATH_MAX];
    int error = 0;
    for (int edges = 0; !error && edges < 2; edges++) {
        (void)snprintf(path, sizeof path, "%s/%s.png", directory, edges ? "mesh" : "mean");
        set_shape(painter, NULL, 0.0);
        error = paint(painter, edges, path, fault);
    }
    if (!error) {
        error = paint_modes(painter, directory, "identity", model->identity_mm, model->n_identity,
                            fault);
    }
    if (!error) {
        error = paint_modes(painter, directory, "expression", model->expression_mm,
                            model->n_expression, fault);
    }
    return error;
}

int sim_head_pictures(const struct iso_head_model *model, const char *directory,
                      struct iso_fault *fault)
{
    struct painter *painter = calloc(1, sizeof *painter);
    struct iso_vec3 *shape_mm = calloc(model->n_vertices, sizeof *shape_mm);
    struct iso_vec3 *seen_mm = calloc(model->n_vertices, sizeof *seen_mm);
    int error = -ENOMEM;
    if (painter && shape_mm && seen_mm) {
        painter->model = model;
        painter->shape_mm = shape_mm;
        painter->seen_mm = seen_mm;
        error = paint_all(painter, directory, fault);
    } else {
        (void)iso_fault_set(fault, error, "%s: out of memory", directory);
    }
    free(seen_mm);
    free(shape_mm);
    free(painter);
    return error;
}
