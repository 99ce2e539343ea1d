/* Isotherms: curves on the surface along which the heat from a landmark is the same.
 *
 * The level is not given but found: the isotherm "of radius r" is the level set that encloses the
 * area pi r^2 (mixture over triangles cut by the level, exact for linear elements), so that the
 * same landmark on two scans gives the same curve whatever the mesh. All loops of the level set are
 * traced; the one that encloses the landmark is kept; one that runs into the mesh's border is open.
 * It is then sampled at n points by polar angle about the landmark in the face frame: from the
 * face's +y, counter-clockwise seen from the front (x to the subject's left is to the viewer's
 * right, so +y, -x, -y, +x). */
#ifndef ISOTHERM_ISOTHERM_CURVE_H
#define ISOTHERM_ISOTHERM_CURVE_H

#include <stdbool.h>
#include <stdint.h>

#include "isotherm/mesh.h"

enum { ISO_ISOTHERM_POINTS_MAX = 64 };

/* Area of {heat >= level}, mm^2, cut triangles counted by the exact part above. */
double iso_isotherm_area_above(const struct iso_mesh *mesh, const double *heat, double level);

/* The level whose superlevel set has the area pi radius^2, by bracketing and regula falsi to 1e-6
 * of the area. -ERANGE if the mesh is smaller than that, or the heat there is 0 or the same
 * throughout. */
int iso_isotherm_level(const struct iso_mesh *mesh, const double *heat, double radius_mm,
                       double *level) __attribute__((warn_unused_result));

/* A traced curve: points in order, closed (last joins first) or open (ends at the border). */
struct iso_curve {
    int32_t n;
    bool closed;
    const struct iso_vec3 *points_mm;
};

/* Workspace: keeps every loop of one level set; sized for a mesh of that many triangles. */
struct iso_tracer;
int iso_tracer_new(int32_t triangle_capacity, struct iso_tracer **out)
    __attribute__((warn_unused_result));
void iso_tracer_free(struct iso_tracer *tracer);

/* Traces all loops of {heat = level} on the mesh by walking from triangle to neighbour (`adjacent`
 * as from iso_mesh_adjacency). The hot side lies on the left seen from outside. Returns the number
 * of curves; they stay valid until the next call. -ENOSPC over the tracer's size. */
int iso_tracer_run(struct iso_tracer *tracer, const struct iso_mesh *mesh,
                   const int32_t (*adjacent)[3], const double *heat, double level)
    __attribute__((warn_unused_result));
struct iso_curve iso_tracer_curve(const struct iso_tracer *tracer, int index);

/* The curve that encloses the landmark, seen along z of the mesh's frame (winding number not zero,
 * open curves closed by a chord); of several the one of the largest enclosed area. Returns its
 * index or -ENOENT. */
int iso_tracer_enclosing(const struct iso_tracer *tracer, struct iso_vec3 landmark_mm);

/* The sampled isotherm: point i at polar angle 2 pi i / n from +y, counter-clockwise seen from the
 * front (+z). Where a ray meets the curve more than once the crossing farthest out counts. weight
 * 0: the ray meets no part of the curve (open isotherm), the point is then 0 and must not be used.
 */
struct iso_isotherm {
    int32_t n;
    bool closed;
    struct iso_vec3 points_mm[ISO_ISOTHERM_POINTS_MAX];
    float weight[ISO_ISOTHERM_POINTS_MAX];
};

/* n_points in 4..ISO_ISOTHERM_POINTS_MAX (-EINVAL). The curve must have at least 3 points
 * (-EINVAL). */
int iso_isotherm_sample_polar(struct iso_curve curve, struct iso_vec3 landmark_mm, int n_points,
                              struct iso_isotherm *out) __attribute__((warn_unused_result));

/* The dissertation's sampling (6.2.3): n points equally spaced by arc length, from the point
 * nearest to the face's +y direction, counter-clockwise. For comparison. */
int iso_isotherm_sample_arc(struct iso_curve curve, struct iso_vec3 landmark_mm, int n_points,
                            struct iso_isotherm *out) __attribute__((warn_unused_result));

#endif
