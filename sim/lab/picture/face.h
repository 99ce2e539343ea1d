/* Pictures of the extractor's result for a face. */
#ifndef SIM_LAB_PICTURE_FACE_H
#define SIM_LAB_PICTURE_FACE_H

#include "core/base/fault.h"
#include "isotherm/extract.h"

/* The content of a picture, in the face frame; the caller owns all of it. */
struct sim_face {
    const struct iso_mesh *mesh;
    struct iso_vec3 landmark_mm[ISO_LANDMARKS]; /* where heat was released */
    const double *heat[ISO_LANDMARKS];          /* [n_vertices] */
    const struct iso_template *tmpl;
};

/* The content from the extractor's last run, whose outcome must be OK. It refers to the extractor
 * and to the extraction, and is valid until the next run. */
struct sim_face sim_face_of(const struct iso_extractor *extractor,
                            const struct iso_extraction *extraction);

/* Angles of the viewer to the face's left and above it. */
struct sim_face_angle {
    double yaw_rad, pitch_rad;
};

/* Draws the mesh with its triangles' edges. All functions: -EINVAL for a mesh without triangles,
 * -ENOMEM, -EIO; each with a fault. */
int sim_picture_mesh(const struct sim_face *face, struct sim_face_angle angle, const char *path,
                     struct iso_fault *fault) __attribute__((warn_unused_result));

/* Draws twelve small faces, each with the heat of one landmark. */
int sim_picture_heat(const struct sim_face *face, struct sim_face_angle angle, const char *path,
                     struct iso_fault *fault) __attribute__((warn_unused_result));

/* Draws the shaded face with its isotherms, one colour for each landmark. */
int sim_picture_isotherms(const struct sim_face *face, struct sim_face_angle angle,
                          const char *path, struct iso_fault *fault)
    __attribute__((warn_unused_result));

#endif
