/* Pictures of the extractor's result for a face. */
#ifndef SIM_LAB_PICTURE_FACE_H
#define SIM_LAB_PICTURE_FACE_H

#include "core/base/fault.h"
#include "isotherm/extract.h"

/* What there is to be drawn, in the face frame; all belongs to the caller. */
struct sim_face {
    const struct iso_mesh *mesh;
    struct iso_vec3 landmark_mm[ISO_LANDMARKS];
    const double *heat[ISO_LANDMARKS]; /* [n_vertices] */
    const struct iso_template *tmpl;
};

/* From the extractor's last run, whose outcome must have been OK; valid until its next. */
struct sim_face sim_face_of(const struct iso_extractor *extractor,
                            const struct iso_extraction *extraction);

/* How much the viewer stands to the face's left and above it. */
struct sim_face_angle {
    double yaw_rad, pitch_rad;
};

/* The mesh with its triangles' edges. -ENOMEM, -EIO; so for the others. */
int sim_picture_mesh(const struct sim_face *face, struct sim_face_angle angle, const char *path,
                     struct iso_fault *fault) __attribute__((warn_unused_result));

/* Twelve small faces, each with the heat of one landmark. */
int sim_picture_heat(const struct sim_face *face, struct sim_face_angle angle, const char *path,
                     struct iso_fault *fault) __attribute__((warn_unused_result));

/* The shaded face with its isotherms, a colour a landmark. */
int sim_picture_isotherms(const struct sim_face *face, struct sim_face_angle angle,
                          const char *path, struct iso_fault *fault)
    __attribute__((warn_unused_result));

#endif
