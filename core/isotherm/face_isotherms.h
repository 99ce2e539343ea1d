/* The isotherms of all landmarks of one face: the points of a template. The surface is a mesh, or
 * the planes of a depth grid. */
#ifndef ISO_CORE_ISOTHERM_FACE_ISOTHERMS_H
#define ISO_CORE_ISOTHERM_FACE_ISOTHERMS_H

#include "core/isotherm/grid_isotherm.h"
#include "core/surface/face_patch.h"
#include "isotherm/isotherm_curve.h"
#include "isotherm/template.h"

/* A face's surface with heat on it, all in the face frame. */
struct iso_heated_face {
    const struct iso_mesh *mesh;
    const int32_t (*adjacent)[3];               /* from iso_mesh_adjacency */
    const struct iso_face_patch *patch;         /* says what was measured; NULL: all of it */
    const double *heat;                         /* [ISO_LANDMARKS][mesh->n_vertices] */
    struct iso_vec3 landmark_mm[ISO_LANDMARKS]; /* on the surface */
};

/* Fills in points_mm, weight and quality of a template whose n_radii, n_points and radius_mm are
 * set. The points of a curve that cannot be found (the isotherm leaves the mesh) get weight 0. The
 * weight of a point on a filled-in surface is the share that was measured there. -ENOSPC if the
 * tracer is too small for the mesh. */
int iso_face_isotherms(struct iso_tracer *tracer, const struct iso_heated_face *face,
                       struct iso_template *tmpl) __attribute__((warn_unused_result));

/* The same on a grid. */
struct iso_heated_grid {
    const struct iso_grid *grid;
    const struct iso_face_patch *patch;
    struct iso_grid_field heat[ISO_LANDMARKS];
    struct iso_vec3 landmark_mm[ISO_LANDMARKS];
};

/* As iso_face_isotherms; cannot fail. */
void iso_face_isotherms_on_grid(struct iso_grid_tracer *tracer, const struct iso_heated_grid *face,
                                struct iso_template *tmpl);

#endif
