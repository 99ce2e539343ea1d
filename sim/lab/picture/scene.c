#include "sim/lab/picture/scene.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "sim/lab/picture/scene_data.h"

static struct iso_rigid camera_of(const struct sim_view *view)
{
    const struct iso_mat3 facing = {{{1, 0, 0}, {0, -1, 0}, {0, 0, -1}}};
    struct iso_mat3 yaw = iso_mat3_rotation(iso_vec3(0, -view->yaw_rad, 0));
    struct iso_mat3 pitch = iso_mat3_rotation(iso_vec3(view->pitch_rad, 0, 0));
    struct iso_mat3 turned = iso_mat3_mul(&pitch, &yaw);
    struct iso_rigid camera_from_face = {.rotation = iso_mat3_mul(&facing, &turned)};
    struct iso_vec3 centre = iso_mat3_apply(&camera_from_face.rotation, view->centre_mm);
    camera_from_face.translation_mm = iso_sub(iso_vec3(0, 0, view->distance_mm), centre);
    return camera_from_face;
}

static struct iso_camera lens_of(const struct sim_view *view, int width, int height)
{
    const double focal = (double)height * view->distance_mm / view->height_mm;
    return (struct iso_camera){
        .projection = ISO_PINHOLE,
        .width_px = width,
        .height_px = height,
        .fx_px = focal,
        .fy_px = focal,
        .cx_px = 0.5 * (width - 1),
        .cy_px = 0.5 * (height - 1),
    };
}

/* Vertex normals: the area-weighted mean of the surrounding triangles' normals. */
static void compute_normals(struct sim_scene *scene)
{
    for (int32_t t = 0; t < scene->mesh->n_triangles; t++) {
        const int32_t *c = scene->mesh->triangles[t];
        struct iso_vec3 a = scene->vertices_mm[c[0]];
        struct iso_vec3 n = iso_cross(iso_sub(scene->vertices_mm[c[1]], a),
                                      iso_sub(scene->vertices_mm[c[2]], a));
        for (int k = 0; k < 3; k++) {
            scene->normals[c[k]] = iso_add(scene->normals[c[k]], n);
        }
    }
    for (int32_t v = 0; v < scene->mesh->n_vertices; v++) {
        scene->normals[v] = iso_unit(scene->normals[v]);
    }
}

int sim_scene_new(const struct iso_mesh *mesh, const struct sim_view *view,
                  struct sim_canvas *canvas, struct sim_scene **out)
{
    if (mesh->n_triangles < 1) {
        return -EINVAL;
    }
    struct sim_scene *scene = calloc(1, sizeof *scene);
    if (!scene) {
        return -ENOMEM;
    }
    const size_t n_samples = (size_t)canvas->width * (size_t)canvas->height;
    scene->mesh = mesh;
    scene->canvas = canvas;
    scene->camera_from_face = camera_of(view);
    scene->raster = (struct iso_raster){
        .camera = lens_of(view, canvas->width, canvas->height),
        .width_px = canvas->width,
        .height_px = canvas->height,
        .depth_mm = calloc(n_samples, sizeof(float)),
        .triangle = calloc(n_samples, sizeof(int32_t)),
        .weight = calloc(n_samples, sizeof(float[2])),
    };
    scene->vertices_mm = calloc((size_t)mesh->n_vertices, sizeof *scene->vertices_mm);
    scene->normals = calloc((size_t)mesh->n_vertices, sizeof *scene->normals);
    if (!scene->raster.depth_mm || !scene->raster.triangle || !scene->raster.weight ||
        !scene->vertices_mm || !scene->normals) {
        sim_scene_free(scene);
        return -ENOMEM;
    }
    for (int32_t v = 0; v < mesh->n_vertices; v++) {
        scene->vertices_mm[v] = iso_rigid_apply(&scene->camera_from_face, mesh->vertices_mm[v]);
    }
    compute_normals(scene);
    iso_raster_clear(&scene->raster);
    /* Indices are never negative, so that their unsigned values are equal. */
    iso_raster_triangles(&scene->raster, scene->vertices_mm,
                         (const uint32_t(*)[3])(const void *)mesh->triangles, mesh->n_triangles, 0,
                         1.0, 1);
    *out = scene;
    return 0;
}

void sim_scene_free(struct sim_scene *scene)
{
    if (scene) {
        free(scene->raster.depth_mm);
        free(scene->raster.triangle);
        free(scene->raster.weight);
        free(scene->vertices_mm);
        free(scene->normals);
        free(scene);
    }
}

struct iso_vec3 sim_scene_interpolate(const struct sim_scene *scene, long sample, int32_t triangle,
                                      const struct iso_vec3 *values)
{
    const int32_t *c = scene->mesh->triangles[triangle];
    const double w1 = (double)scene->raster.weight[sample][0];
    const double w2 = (double)scene->raster.weight[sample][1];
    return iso_madd(iso_madd(iso_scale(1.0 - w1 - w2, values[c[0]]), w1, values[c[1]]), w2,
                    values[c[2]]);
}
