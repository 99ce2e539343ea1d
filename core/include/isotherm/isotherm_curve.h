/** @file
 * Isotherms: curves on the surface along which the heat from a landmark is the same (Abdelrahman
 * 2013, section 6.2).
 *
 * The level is not given but found: the isotherm "of radius r" is the level set that encloses the
 * area pi r^2 (over triangles that the level cuts the area is exact for linear elements), so that
 * the same landmark on two scans gives the same curve whatever the mesh. All loops of the level set
 * are traced. The one that encloses the landmark is kept; one that runs into the mesh's border is
 * open. It is then sampled at n points by polar angle about the landmark in the face frame: from
 * the face's +y, counter-clockwise seen from the front (x to the subject's left is to the viewer's
 * right, so +y, -x, -y, +x). */
#ifndef ISOTHERM_ISOTHERM_CURVE_H
#define ISOTHERM_ISOTHERM_CURVE_H

#include <stdbool.h>
#include <stdint.h>

#include "isotherm/mesh.h"

enum {
    ISO_ISOTHERM_POINTS_MAX = 64, /**< Most points of a sampled isotherm. */
};

/** Area where the heat is at least a level. Triangles that the level cuts count with the part
 * above.
 *
 * @param mesh   The mesh.
 * @param heat   [n_vertices]: the temperature.
 * @param level  The level.
 * @return The area, mm^2. */
double iso_isotherm_area_above(const struct iso_mesh *mesh, const double *heat, double level);

/** The level that encloses the area of a disc, by bracketing and regula falsi to 1e-6 of the area.
 * Levels lie above 0, and at most 12 orders of magnitude below the highest temperature.
 *
 * @param mesh       The mesh.
 * @param heat       [n_vertices]: the temperature.
 * @param radius_mm  Radius of the disc, mm.
 * @param level      Receives the level.
 * @return 0; -ERANGE if the mesh is smaller than the disc, or the heat is the same everywhere;
 *         -ENOMEM. */
int iso_isotherm_level(const struct iso_mesh *mesh, const double *heat, double radius_mm,
                       double *level) __attribute__((warn_unused_result));

/** A traced curve. */
struct iso_curve {
    int32_t n;   /**< Points. */
    bool closed; /**< The last point joins the first; else the curve ends at the border. */
    const struct iso_vec3 *points_mm; /**< [n]: points in order, mm; they belong to the tracer. */
};

/** The workspace of a tracer: it keeps every loop of one level set. */
struct iso_tracer;

/** Makes a tracer.
 *
 * @param triangle_capacity  Most triangles of a mesh.
 * @param out                Receives the tracer; free it with iso_tracer_free().
 * @return 0; -EINVAL; -ENOMEM. */
int iso_tracer_new(int32_t triangle_capacity, struct iso_tracer **out)
    __attribute__((warn_unused_result));

/** Frees a tracer.
 *
 * @param tracer  The tracer, or NULL. */
void iso_tracer_free(struct iso_tracer *tracer);

/** Traces all curves of {heat = level} on a mesh by walking from triangle to neighbour. The hot
 * side lies on the left seen from outside.
 *
 * @param tracer    The tracer.
 * @param mesh      The mesh.
 * @param adjacent  [n_triangles][3]: from iso_mesh_adjacency().
 * @param heat      [n_vertices]: the temperature.
 * @param level     The level.
 * @return The number of curves, which stay valid until the next call; -ENOSPC if the mesh has more
 *         triangles than the tracer has room for. */
int iso_tracer_run(struct iso_tracer *tracer, const struct iso_mesh *mesh,
                   const int32_t (*adjacent)[3], const double *heat, double level)
    __attribute__((warn_unused_result));

/** One of the curves that were traced last.
 *
 * @param tracer  The tracer.
 * @param index   Index of the curve, from 0.
 * @return The curve. */
struct iso_curve iso_tracer_curve(const struct iso_tracer *tracer, int index);

/** The curve that encloses a landmark, seen along z of the mesh's frame: its winding number is not
 * zero, where open curves are closed by a chord. Of several it is the one of the largest area.
 *
 * @param tracer       The tracer.
 * @param landmark_mm  The landmark, mm.
 * @return Index of the curve; -ENOENT if no curve encloses the landmark. */
int iso_tracer_enclosing(const struct iso_tracer *tracer, struct iso_vec3 landmark_mm);

/** A sampled isotherm: point i lies at the polar angle 2 pi i / n from +y, counter-clockwise seen
 * from the front (+z). */
struct iso_isotherm {
    int32_t n;                                          /**< Points. */
    bool closed;                                        /**< Whether the curve is closed. */
    struct iso_vec3 points_mm[ISO_ISOTHERM_POINTS_MAX]; /**< [n]: points, mm. */
    /** [n]: 0 where the ray meets no part of the curve (open isotherm); the point is then 0 and may
     * not be used. */
    float weight[ISO_ISOTHERM_POINTS_MAX];
};

/** Samples a curve by polar angle. Where a ray meets the curve more than once, the crossing
 * farthest out counts.
 *
 * @param curve        The curve, of at least 3 points.
 * @param landmark_mm  The centre of the angles, mm.
 * @param n_points     How many points, 4..ISO_ISOTHERM_POINTS_MAX.
 * @param out          Receives the sampled isotherm.
 * @return 0; -EINVAL. */
int iso_isotherm_sample_polar(struct iso_curve curve, struct iso_vec3 landmark_mm, int n_points,
                              struct iso_isotherm *out) __attribute__((warn_unused_result));

/** Samples a curve as the dissertation does (6.2.3), for comparison: n points equally spaced by arc
 * length, from the point nearest to the face's +y direction, counter-clockwise.
 *
 * @param curve        The curve, of at least 3 points.
 * @param landmark_mm  The landmark, mm.
 * @param n_points     How many points, 4..ISO_ISOTHERM_POINTS_MAX.
 * @param out          Receives the sampled isotherm.
 * @return 0; -EINVAL. */
int iso_isotherm_sample_arc(struct iso_curve curve, struct iso_vec3 landmark_mm, int n_points,
                            struct iso_isotherm *out) __attribute__((warn_unused_result));

#endif
