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
    const struct iso_face_patch *patch;         /* knows what was measured; NULL: everything was */
    const double *heat;                         /* [ISO_LANDMARKS][mesh->n_vertices] */
    struct iso_vec3 landmark_mm[ISO_LANDMARKS]; /* on the surface */
};

/* Fills in points_mm, weight and quality of a template whose n_radii, n_points and radius_mm are
 * set. The weight of a point is the share of the surface that was measured there, 0..1. It is 0 for
 * a point that the isotherm does not have, for example because it leaves the mesh. -ENOSPC if the
 * tracer is too small for the mesh. */
int iso_face_isotherms(struct iso_tracer *tracer, const struct iso_heated_face *face,
                       struct iso_template *tmpl) __attribute__((warn_unused_result));

/* The same for a surface that is a depth grid. */
struct iso_heated_grid {
    const struct iso_grid *grid;
    const struct iso_face_patch *patch;         /* as above */
    struct iso_grid_field heat[ISO_LANDMARKS];  /* the heat of each landmark */
    struct iso_vec3 landmark_mm[ISO_LANDMARKS]; /* on the surface */
};

/* The same as iso_face_isotherms on a grid. It cannot fail. */
void iso_face_isotherms_on_grid(struct iso_grid_tracer *tracer, const struct iso_heated_grid *face,
                                struct iso_template *tmpl);

#endif
