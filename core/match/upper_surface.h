/* The upper face as a surface: its heights and slopes, also between the nodes; and how well two
 * surfaces agree after one is rigidly registered to the other. */
#ifndef ISO_CORE_MATCH_UPPER_SURFACE_H
#define ISO_CORE_MATCH_UPPER_SURFACE_H

#include "core/match/upper_face.h"

/* A node: its height, its slopes dz/dx and dz/dy, and 1 if it was measured, else 0. Height and
 * slopes are NaN where the node or one of its four neighbours has no surface. */
struct iso_upper_node {
    float z_mm, slope_x, slope_y, measured;
};

struct iso_upper_surface {
    struct iso_upper_node node[ISO_UPPER_ROWS][ISO_UPPER_COLUMNS];
};

/* A place between nodes, by bilinear interpolation; `measured` is a share, 0..1. */
struct iso_upper_place {
    double z_mm, slope_x, slope_y, measured;
};

/* The surface of a face. */
void iso_upper_surface_of(const struct iso_upper_face *face, struct iso_upper_surface *out);

/* The surface at (x, y) of the face frame. Returns false where there is none. */
bool iso_upper_surface_at(const struct iso_upper_surface *surface, double x_mm, double y_mm,
                          struct iso_upper_place *out);

/* The same as iso_upper_surface_at() of iso_upper_surface_of(face), to the bit, for callers that
 * need so few places that the surface is not worth its memory. */
bool iso_upper_face_at(const struct iso_upper_face *face, double x_mm, double y_mm,
                       struct iso_upper_place *out);

/* A point of the probe and the plane of the gallery's surface below it. */
struct iso_upper_pair {
    struct iso_vec3 at_mm, normal; /* the moved point; the normal of the plane */
    double residual_mm;            /* the distance of the point from the plane, along the normal */
};

/* Working memory of a fit, 73 kB: too large for the stack. It is biometric data: the caller wipes
 * it. */
struct iso_upper_workspace {
    struct iso_vec3 points_mm[ISO_UPPER_NODES / 2 + 1];
    struct iso_upper_pair pairs[ISO_UPPER_NODES / 2 + 1];
};

struct iso_upper_fit {
    double rms_mm;  /* root mean square distance from point to plane, closest 80 % of the pairs */
    double overlap; /* share of the probe's points that have a partner, 0..1 */
    int iterations;
    struct iso_rigid gallery_from_probe;
};

/* Registers the probe's upper face to a gallery's by iterative closest point from point to plane
 * (Chen and Medioni 1991). The partner of a point is the surface below it (projective association:
 * Blais and Levine 1995). The closest 80 % of the pairs count (Chetverikov and others 2002). Both
 * faces start in the face frames of their fitted heads. Every second measured node of the probe is
 * a point. -ENODATA if fewer than 60 pairs, or pairs of less than 30 % of the points, are found. */
int iso_upper_fit(struct iso_upper_workspace *work, const struct iso_upper_face *probe,
                  const struct iso_upper_surface *gallery, struct iso_upper_fit *out)
    __attribute__((warn_unused_result));

#endif
