/* A height field of the upper face between its nodes: heights and slopes; and how well two of them
 * agree once one is registered rigidly to the other. */
#ifndef ISO_CORE_MATCH_UPPER_SURFACE_H
#define ISO_CORE_MATCH_UPPER_SURFACE_H

#include "core/match/upper_face.h"

/* A node: height, slopes dz/dx and dz/dy, 1 if measured. NaN where slopes are not known. */
struct iso_upper_node {
    float z_mm, slope_x, slope_y, measured;
};

struct iso_upper_surface {
    struct iso_upper_node node[ISO_UPPER_ROWS][ISO_UPPER_COLUMNS];
};

/* Between nodes, bilinear; `measured` is the share, 0..1. */
struct iso_upper_place {
    double z_mm, slope_x, slope_y, measured;
};

void iso_upper_surface_of(const struct iso_upper_face *face, struct iso_upper_surface *out);

/* False where there is no surface. */
bool iso_upper_surface_at(const struct iso_upper_surface *surface, double x_mm, double y_mm,
                          struct iso_upper_place *out);

/* The same as iso_upper_surface_at() of iso_upper_surface_of(face), to the bit, for callers that
 * need so few places that the surface is not worth its memory. */
bool iso_upper_face_at(const struct iso_upper_face *face, double x_mm, double y_mm,
                       struct iso_upper_place *out);

/* A probe's point on the gallery's surface: where, the normal there, and how far apart they are. */
struct iso_upper_pair {
    struct iso_vec3 at_mm, normal;
    double residual_mm;
};

/* Working memory of a fit, 75 kB: too much for a stack. Biometric: the caller
 * wipes it. */
struct iso_upper_workspace {
    struct iso_vec3 points_mm[ISO_UPPER_NODES / 2 + 1];
    struct iso_upper_pair pairs[ISO_UPPER_NODES / 2 + 1];
};

struct iso_upper_fit {
    double rms_mm;  /* of what is left from point to plane, of the closest 80 % of the pairs */
    double overlap; /* share of the probe's points that have a partner, 0..1 */
    int iterations;
    struct iso_rigid gallery_from_probe;
};

/* Registers the probe's upper face to a gallery's by iterative closest point from point to plane
 * (Chen and Medioni 1991), the partner of a point being the surface below it (projective
 * association: Blais and Levine 1995), with the closest 80 % of the pairs (Chetverikov and others
 * 2002). Both start in the face frame of their fitted heads. Every second measured node of the
 * probe is a point. -ENODATA with fewer than 60 pairs or less than 30 % of the points. */
int iso_upper_fit(struct iso_upper_workspace *work, const struct iso_upper_face *probe,
                  const struct iso_upper_surface *gallery, struct iso_upper_fit *out)
    __attribute__((warn_unused_result));

#endif
