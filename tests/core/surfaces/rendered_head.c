#include "tests/core/surfaces/rendered_head.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

#include "core/surface/raster.h"

struct iso_camera rendered_head_camera(void)
{
    return (struct iso_camera){.projection = ISO_PINHOLE,
                               .width_px = 640,
                               .height_px = 480,
                               .fx_px = 575.0,
                               .fy_px = 570.0,
                               .cx_px = 310.0,
                               .cy_px = 250.0};
}

struct iso_frame *rendered_head_frame(void)
{
    struct iso_camera camera = rendered_head_camera();
    struct iso_frame *frame = NULL;
    assert_int_equal(iso_frame_new(&camera, camera.width_px, camera.height_px, false, &frame), 0);
    return frame;
}

struct iso_rigid rendered_head_pose(double yaw_deg, double pitch_deg, struct iso_vec3 nose_mm)
{
    const double rad = M_PI / 180.0;
    struct iso_mat3 facing = {{{1, 0, 0}, {0, -1, 0}, {0, 0, -1}}};
    struct iso_mat3 yaw = iso_mat3_rotation(iso_vec3(0, yaw_deg * rad, 0));
    struct iso_mat3 pitch = iso_mat3_rotation(iso_vec3(-pitch_deg * rad, 0, 0));
    struct iso_mat3 turned = iso_mat3_mul(&yaw, &pitch);
    return (struct iso_rigid){iso_mat3_mul(&facing, &turned), nose_mm};
}

void rendered_head_draw(struct iso_frame *frame, const struct iso_head_model *model,
                        const struct iso_vec3 *shape_mm, double size, const struct iso_rigid *pose)
{
    struct iso_vec3 *vertices = calloc(model->n_vertices, sizeof *vertices);
    assert_non_null(vertices);
    for (uint32_t i = 0; i < model->n_vertices; i++) {
        struct iso_vec3 p = shape_mm ? shape_mm[i] : model->mean_mm[i];
        vertices[i] = iso_rigid_apply(pose, iso_scale(size, p));
    }
    const struct iso_raster raster = {
        .camera = frame->camera,
        .width_px = frame->width_px,
        .height_px = frame->height_px,
        .crop_x_px = frame->crop_x_px,
        .crop_y_px = frame->crop_y_px,
        .depth_mm = frame->depth_mm,
    };
    iso_raster_triangles(&raster, vertices, (const uint32_t(*)[3])model->triangles,
                         (int32_t)model->n_triangles, 0, 1.0, 1);
    free(vertices);
}

struct iso_mesh *rendered_head_mesh(const struct iso_head_model *model,
                                    const struct iso_vec3 *shape_mm, const struct iso_rigid *pose)
{
    struct iso_mesh *mesh = NULL;
    assert_int_equal(iso_mesh_new((int32_t)model->n_vertices, (int32_t)model->n_triangles, &mesh),
                     0);
    mesh->n_vertices = mesh->vertex_capacity;
    mesh->n_triangles = mesh->triangle_capacity;
    for (uint32_t i = 0; i < model->n_vertices; i++) {
        struct iso_vec3 p = shape_mm ? shape_mm[i] : model->mean_mm[i];
        mesh->vertices_mm[i] = iso_rigid_apply(pose, p);
    }
    for (uint32_t t = 0; t < model->n_triangles; t++) {
        for (int k = 0; k < 3; k++) {
            mesh->triangles[t][k] = (int32_t)model->triangles[t][k];
        }
    }
    return mesh;
}

void rendered_head_clear(struct iso_frame *frame)
{
    for (int i = 0; i < frame->width_px * frame->height_px; i++) {
        frame->depth_mm[i] = 0.0f;
    }
}

void rendered_head_wall(struct iso_frame *frame, float depth_mm)
{
    for (int i = 0; i < frame->width_px * frame->height_px; i++) {
        frame->depth_mm[i] = frame->depth_mm[i] > 0.0f ? frame->depth_mm[i] : depth_mm;
    }
}

double rendered_head_angle_deg(const struct iso_mat3 *a, const struct iso_mat3 *b)
{
    struct iso_mat3 bt = iso_mat3_transpose(b);
    struct iso_mat3 c = iso_mat3_mul(&bt, a);
    double cosine = (c.m[0][0] + c.m[1][1] + c.m[2][2] - 1.0) / 2.0;
    return acos(fmin(fmax(cosine, -1.0), 1.0)) * 180.0 / M_PI;
}

void rendered_head_assert_pose(const struct iso_rigid *found, const struct iso_rigid *truth,
                               double within_mm, double within_deg)
{
    double off_mm = iso_norm(iso_sub(found->translation_mm, truth->translation_mm));
    double off_deg = rendered_head_angle_deg(&found->rotation, &truth->rotation);
    if (!(off_mm <= within_mm && off_deg <= within_deg)) {
        fail_msg("%.2f mm and %.2f degrees off", off_mm, off_deg);
    }
}
