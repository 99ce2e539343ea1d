/* Heads of a model (shipped_model.h), rendered into depth frames. The test knows their pose and
 * shape exactly. A failure fails the running cmocka test. */
#ifndef TESTS_CORE_SURFACES_RENDERED_HEAD_H
#define TESTS_CORE_SURFACES_RENDERED_HEAD_H

#include "isotherm/frame.h"
#include "isotherm/head_model.h"
#include "isotherm/mesh.h"

/* A camera of 640 x 480 pixels. Its principal point is not the centre, and its two focal lengths
 * differ a little. */
struct iso_camera rendered_head_camera(void);

/* Returns an empty frame of that camera. Free it with iso_frame_free. */
struct iso_frame *rendered_head_frame(void);

/* Returns camera_from_face of a head whose nose tip is at a place. yaw > 0 is turned to the
 * subject's left, pitch > 0 is up, as in iso_extraction. */
struct iso_rigid rendered_head_pose(double yaw_deg, double pitch_deg, struct iso_vec3 nose_mm);

/* Draws a head into the frame. At each pixel the nearest surface remains. `shape_mm` NULL is the
 * mean head. `size` scales it about the nose tip. */
void rendered_head_draw(struct iso_frame *frame, const struct iso_head_model *model,
                        const struct iso_vec3 *shape_mm, double size, const struct iso_rigid *pose);

/* Returns the same head as a mesh in the camera frame. Free it with iso_mesh_free. */
struct iso_mesh *rendered_head_mesh(const struct iso_head_model *model,
                                    const struct iso_vec3 *shape_mm, const struct iso_rigid *pose);

/* Makes the whole frame empty again. */
void rendered_head_clear(struct iso_frame *frame);

/* Draws a flat wall at a depth, behind the objects in the frame. */
void rendered_head_wall(struct iso_frame *frame, float depth_mm);

/* Returns the angle between two rotations, in degrees. */
double rendered_head_angle_deg(const struct iso_mat3 *a, const struct iso_mat3 *b);

/* Fails unless a pose differs from the truth by at most so many millimetres and degrees. */
void rendered_head_assert_pose(const struct iso_rigid *found, const struct iso_rigid *truth,
                               double within_mm, double within_deg);

#endif
