#include "drivers/stereo/rectification.h"

#include <stddef.h>

struct iso_rectification iso_rectification_of(const struct iso_stereo_calibration *c)
{
    const struct iso_camera *left = &c->camera[ISO_EYE_LEFT], *right = &c->camera[ISO_EYE_RIGHT];
    struct iso_rigid left_from_right = iso_rigid_inverse(&c->right_from_left);
    const struct iso_vec3 forward = {0.0, 0.0, 1.0};
    const struct iso_vec3 other = iso_mat3_apply(&left_from_right.rotation, forward);
    const struct iso_vec3 x = iso_unit(left_from_right.translation_mm);
    const struct iso_vec3 y = iso_unit(iso_cross(iso_add(iso_unit(other), forward), x));
    const struct iso_vec3 z = iso_cross(x, y);
    struct iso_rectification out = {
        .camera = {.projection = ISO_PINHOLE,
                   .width_px = left->width_px,
                   .height_px = left->height_px,
                   .cx_px = 0.5 * (left->width_px - 1),
                   .cy_px = 0.5 * (left->height_px - 1)},
        .baseline_mm = iso_stereo_baseline_mm(c),
    };
    const double focal_px = 0.25 * (left->fx_px + left->fy_px + right->fx_px + right->fy_px);
    out.camera.fx_px = out.camera.fy_px = nearbyint(focal_px);
    out.rectified_from_eye[ISO_EYE_LEFT] = (struct iso_mat3){
        {{x.x, x.y, x.z}, {y.x, y.y, y.z}, {z.x, z.y, z.z}}};
    out.rectified_from_eye[ISO_EYE_RIGHT] = iso_mat3_mul(&out.rectified_from_eye[ISO_EYE_LEFT],
                                                         &left_from_right.rotation);
    return out;
}

void iso_rectification_map(const struct iso_rectification *rectification,
                           const struct iso_stereo_calibration *calibration, enum iso_eye eye,
                           float *x_px, float *y_px)
{
    const struct iso_camera *camera = &rectification->camera;
    struct iso_mat3 eye_from_rectified = iso_mat3_transpose(
        &rectification->rectified_from_eye[eye]);
    size_t i = 0;
    for (int row = 0; row < camera->height_px; row++) {
        for (int column = 0; column < camera->width_px; column++, i++) {
            double u_px = -1e4, v_px = -1e4;
            const struct iso_vec3 sight = iso_camera_back_project(camera, column, row, 1.0);
            (void)iso_camera_project(&calibration->camera[eye],
                                     iso_mat3_apply(&eye_from_rectified, sight), &u_px, &v_px);
            x_px[i] = (float)u_px;
            y_px[i] = (float)v_px;
        }
    }
}
