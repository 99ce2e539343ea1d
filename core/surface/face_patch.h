/* The measured face resampled in its own frame: an orthographic depth grid about the nose tip, with
 * its holes filled. The grid is the same for every person, pose and sensor.
 *
 * Places without a measurement (shadows, hair, the far side of a turned head) are filled in on the
 * residual to the mean face, not on the depth itself. The residual is smooth, so that a hole gets
 * the relief of the mean face, shifted to fit its surroundings. (Filling the depth instead leaves a
 * fifth of the isotherms open and costs 20 points of rank-1.) Filled-in places are recorded, so
 * that points of isotherms there get no weight.
 *
 * Grid: an orthographic iso_frame seen from the front: x right = face x, y down = -face y, depth =
 * ISO_FACE_PATCH_ORIGIN_MM - face z. Its domain is the set of pixels that have values: the pixels
 * within the crop radius where the mean face has a surface that is not too steep, as far as they
 * are connected with the nose tip, and the steep places that they enclose. The domain is fixed when
 * the patch is created. */
#ifndef ISO_CORE_SURFACE_FACE_PATCH_H
#define ISO_CORE_SURFACE_FACE_PATCH_H

#include "isotherm/frame.h"
#include "isotherm/head_model.h"
#include "isotherm/mesh.h"

#define ISO_FACE_PATCH_ORIGIN_MM 250.0

struct iso_face_patch_options {
    double radius_mm;    /* about the nose tip */
    double spacing_mm;   /* of the grid */
    double smoothing_mm; /* sigma of the Gaussian that smooths the residual; 0: none */
    double outlier_mm;   /* a residual beyond this is not the face (hair, hand): filled in */
};

struct iso_face_patch;

/* Makes a patch for the mean face of a model; the model is not needed afterwards. -EINVAL for
 * options out of range (radius 40..150, spacing 0.5..8, smoothing 0..20, outlier > 0), -ENOMEM. */
int iso_face_patch_new(const struct iso_head_model *model,
                       const struct iso_face_patch_options *options, struct iso_face_patch **out)
    __attribute__((warn_unused_result));

/* Wipes the residual and the depth of the last face, and frees the patch. NULL is accepted. */
void iso_face_patch_free(struct iso_face_patch *patch);

/* Resamples the surface that a frame measured, given the pose of the face. Triangles of the surface
 * that span more than jump_mm of the frame's depth are left out. Returns the share of the domain
 * that was measured, 0..1. */
double iso_face_patch_resample(struct iso_face_patch *patch, const struct iso_frame *frame,
                               double jump_mm, const struct iso_rigid *camera_from_face);

/* The same for any surface, with which tests compare; the appliance resamples frames. The mesh that
 * iso_triangulate() makes of a frame gives the same patch (resample.h). The surface is a
 * camera-frame mesh; its vertices are moved in place to the frame of the patch. */
double iso_face_patch_build(struct iso_face_patch *patch, struct iso_mesh *surface,
                            const struct iso_rigid *camera_from_face);

/* The grid as a depth frame, which belongs to the patch: holes are filled, 0 outside the domain. */
const struct iso_frame *iso_face_patch_frame(const struct iso_face_patch *patch);

/* How much of the surroundings of a place in the face frame was measured and not filled in, 0..1:
 * bilinear between the four grid points about it; 0 outside the grid. */
double iso_face_patch_measured(const struct iso_face_patch *patch, double x_mm, double y_mm);

/* The grid column and row, with fractions, of a place in the face frame. */
void iso_face_patch_pixel(const struct iso_face_patch *patch, double x_mm, double y_mm,
                          double *column, double *row);

/* A point of the grid's camera frame in the face frame. */
static inline struct iso_vec3 iso_face_from_patch(struct iso_vec3 p)
{
    return iso_vec3(p.x, -p.y, ISO_FACE_PATCH_ORIGIN_MM - p.z);
}

/* A point of the face frame in the grid's camera frame. */
static inline struct iso_vec3 iso_patch_from_face(struct iso_vec3 p)
{
    return iso_vec3(p.x, -p.y, ISO_FACE_PATCH_ORIGIN_MM - p.z);
}

#endif
