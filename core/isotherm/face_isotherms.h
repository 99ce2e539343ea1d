/* The isotherms of all landmarks of one face: the points of a template. */
#ifndef ISO_CORE_ISOTHERM_FACE_ISOTHERMS_H
#define ISO_CORE_ISOTHERM_FACE_ISOTHERMS_H

#include "core/isotherm/isotherm.h"
#include "core/match/template.h"
#include "core/surface/face_patch.h"

/* A face's surface with heat on it, all in the face frame. */
struct iso_heated_face {
    const struct iso_mesh *mesh;
    const int32_t (*adjacent)[3];               /* from iso_mesh_adjacency */
    const struct iso_face_patch *patch;         /* says what was measured */
    const double *heat;                         /* [ISO_LANDMARKS][mesh->n_vertices] */
    struct iso_vec3 landmark_mm[ISO_LANDMARKS]; /* on the surface */
};

/* Fills in points_mm, weight and quality of a template whose n_radii, n_points and radius_mm are
 * set. A curve that cannot be found (the isotherm leaves the mesh) leaves its points at weight 0; a
 * point on filled-in surface weighs as little as was measured there. -ENOSPC if the tracer is too
 * small for the mesh. */
int iso_face_isotherms(struct iso_tracer *tracer, const struct iso_heated_face *face,
                       struct iso_template *tmpl) __attribute__((warn_unused_result));

#endif
