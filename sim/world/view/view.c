#include "sim/world/view/view.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "core/surface/raster.h"

static size_t pixels(const struct sim_view *view)
{
    return (size_t)view->camera.width_px * (size_t)view->camera.height_px;
}

/* Pixel centres are at integers, so that sensor pixel u covers view pixels s u .. s u + s - 1,
 * and its middle is s u + (s - 1) / 2. */
static struct iso_camera supersampled(const struct iso_camera *camera, int s)
{
    struct iso_camera fine = *camera;
    fine.width_px *= s;
    fine.height_px *= s;
    fine.fx_px *= s;
    fine.fy_px *= s;
    fine.pitch_mm /= s;
    fine.cx_px = s * camera->cx_px + 0.5 * (s - 1);
    fine.cy_px = s * camera->cy_px + 0.5 * (s - 1);
    return fine;
}

int sim_view_new(const struct iso_camera *sensor_camera, int supersample, struct sim_view **out)
{
    if (supersample < 1 || supersample > 4 || iso_camera_check(sensor_camera, NULL) != 0) {
        return -EINVAL;
    }
    struct sim_view *view = calloc(1, sizeof *view);
    if (!view) {
        return -ENOMEM;
    }
    view->camera = supersampled(sensor_camera, supersample);
    view->supersample = supersample;
    const size_t n = pixels(view);
    view->depth_mm = malloc(n * sizeof *view->depth_mm);
    view->cosine = malloc(n * sizeof *view->cosine);
    view->material = malloc(n * sizeof *view->material);
    view->facet = malloc(n * sizeof *view->facet);
    if (!view->depth_mm || !view->cosine || !view->material || !view->facet) {
        sim_view_free(view);
        return -ENOMEM;
    }
    sim_view_clear(view);
    *out = view;
    return 0;
}

void sim_view_free(struct sim_view *view)
{
    if (!view) {
        return;
    }
    free(view->depth_mm);
    free(view->cosine);
    free(view->material);
    free(view->facet);
    free(view->facets);
    free(view->companion_mm);
    free(view);
}

static struct iso_raster raster_of(const struct sim_view *view)
{
    return (struct iso_raster){
        .camera = view->camera,
        .width_px = view->camera.width_px,
        .height_px = view->camera.height_px,
        .depth_mm = view->depth_mm,
        .triangle = view->facet,
    };
}

void sim_view_clear(struct sim_view *view)
{
    struct iso_raster raster = raster_of(view);
    iso_raster_clear(&raster);
    memset(view->cosine, 0, pixels(view) * sizeof *view->cosine);
    memset(view->material, SIM_NOTHING, pixels(view));
    view->n_facets = 0;
    for (int i = 0; i < view->n_companions; i++) {
        sim_view_clear(view->companions[i].view);
    }
}

static int reserve_facets(struct sim_view *view, uint32_t n)
{
    if ((uint32_t)(view->facet_capacity - view->n_facets) >= n) {
        return 0;
    }
    if (n > INT32_MAX / 2 - (uint32_t)view->n_facets) {
        return -ENOMEM;
    }
    const int32_t capacity = 2 * (view->n_facets + (int32_t)n);
    struct sim_facet *facets = realloc(view->facets, (size_t)capacity * sizeof *facets);
    if (!facets) {
        return -ENOMEM;
    }
    view->facets = facets;
    view->facet_capacity = capacity;
    return 0;
}

static int reserve_companion(struct sim_view *view, size_t n)
{
    if (view->companion_capacity >= n) {
        return 0;
    }
    struct iso_vec3 *vertices = realloc(view->companion_mm, n * sizeof *vertices);
    if (!vertices) {
        return -ENOMEM;
    }
    view->companion_mm = vertices;
    view->companion_capacity = n;
    return 0;
}

static int draw_companions(struct sim_view *view, const struct iso_vec3 *vertices_mm,
                           const uint32_t (*triangles)[3], uint32_t n_triangles,
                           enum sim_material material)
{
    uint32_t last = 0;
    for (uint32_t i = 0; view->n_companions > 0 && i < n_triangles; i++) {
        for (int k = 0; k < 3; k++) {
            last = triangles[i][k] > last ? triangles[i][k] : last;
        }
    }
    int error = view->n_companions > 0 ? reserve_companion(view, (size_t)last + 1) : 0;
    for (int c = 0; error == 0 && c < view->n_companions; c++) {
        const struct sim_companion *companion = &view->companions[c];
        for (uint32_t i = 0; i <= last; i++) {
            view->companion_mm[i] = iso_rigid_apply(&companion->companion_from_view,
                                                    vertices_mm[i]);
        }
        error = sim_view_draw(companion->view, view->companion_mm, triangles, n_triangles,
                              material);
    }
    return error;
}

int sim_view_draw(struct sim_view *view, const struct iso_vec3 *vertices_mm,
                  const uint32_t (*triangles)[3], uint32_t n_triangles, enum sim_material material)
{
    const int error = reserve_facets(view, n_triangles);
    if (error != 0) {
        return error;
    }
    for (uint32_t i = 0; i < n_triangles; i++) {
        struct iso_vec3 a = vertices_mm[triangles[i][0]];
        struct iso_vec3 ab = iso_sub(vertices_mm[triangles[i][1]], a);
        struct iso_vec3 ac = iso_sub(vertices_mm[triangles[i][2]], a);
        view->facets[view->n_facets + (int32_t)i] = (struct sim_facet){
            .normal = iso_unit(iso_cross(ab, ac)), .material = material};
    }
    struct iso_raster raster = raster_of(view);
    iso_raster_triangles(&raster, vertices_mm, triangles, (int32_t)n_triangles, view->n_facets,
                         SIM_VIEW_NEAR_MM, 0);
    view->n_facets += (int32_t)n_triangles;
    return draw_companions(view, vertices_mm, triangles, n_triangles, material);
}

void sim_view_paint(struct sim_view *view, const float *albedo, uint32_t n)
{
    struct sim_facet *last = view->facets + view->n_facets - n;
    for (uint32_t i = 0; i < n; i++) {
        last[i].albedo = albedo[i];
    }
    for (int c = 0; c < view->n_companions; c++) {
        sim_view_paint(view->companions[c].view, albedo, n);
    }
}

void sim_view_finish(struct sim_view *view)
{
    const struct iso_camera *camera = &view->camera;
    size_t i = 0;
    for (int c = 0; c < view->n_companions; c++) {
        sim_view_finish(view->companions[c].view);
    }
    for (int row = 0; row < camera->height_px; row++) {
        for (int column = 0; column < camera->width_px; column++, i++) {
            if (view->facet[i] < 0) {
                continue;
            }
            const struct sim_facet *facet = &view->facets[view->facet[i]];
            struct iso_vec3 sight = {0.0, 0.0, 1.0};
            if (camera->projection == ISO_PINHOLE) {
                sight = iso_unit(iso_vec3((column - camera->cx_px) / camera->fx_px,
                                          (row - camera->cy_px) / camera->fy_px, 1.0));
            }
            view->cosine[i] = (float)fabs(iso_dot(facet->normal, sight));
            view->material[i] = (uint8_t)facet->material;
        }
    }
}
