/* How well a plane, or a sheet of paper that is bent in any way about one direction, fits a piece
 * of surface.
 *
 * Prints and displays are flat or bent: they are developable surfaces, whose Gaussian curvature is
 * 0 (do Carmo 1976, sec. 3-3). A sheet that is rolled, wavy or folded about one direction is a
 * generalised cylinder, over any plane that is not perpendicular to that direction:
 *
 *     z = c s + f(t),   t = x cos a + y sin a,   s = y cos a - x sin a,
 *
 * with rulings along s and any profile f. The profile is piecewise linear here, so that it fits
 * creases as well as rolls. No angle fits a face, because a nose is curved in both directions. */
#ifndef ISO_CORE_PRESENTATION_BENT_SHEET_H
#define ISO_CORE_PRESENTATION_BENT_SHEET_H

#include "isotherm/vec.h"

enum { ISO_SHEET_POINTS_MAX = 1024 };

struct iso_sheet_fit {
    double rms_mm;       /* root mean square of residuals, each limited to `limit_mm` */
    double inlier_share; /* share of the points that lie nearer than half of `limit_mm` */
    double bend_mm;      /* range of f(t) minus the line through its ends; 0 for a plane */
    double angle_rad;    /* a, 0..pi; 0 for a plane */
};

/* Fits the plane z = a + b x + c y to n points (plane = {a, b, c}), by iteratively reweighted least
 * squares with Tukey's biweight, so that a finger in front of the sheet has no effect. Residuals
 * are measured along z. -ENODATA for fewer than 24 or more than ISO_SHEET_POINTS_MAX points, or if
 * they do not span a surface. */
int iso_plane_fit(const struct iso_vec3 *points_mm, int n, double limit_mm, double plane[3],
                  struct iso_sheet_fit *out) __attribute__((warn_unused_result));

/* Fits the bent sheet in the same way. */
int iso_bent_sheet_fit(const struct iso_vec3 *points_mm, int n, double limit_mm,
                       struct iso_sheet_fit *out) __attribute__((warn_unused_result));

/* Height of a point over a plane, along z. */
static inline double iso_above_plane(const double plane[3], struct iso_vec3 p)
{
    return p.z - plane[0] - plane[1] * p.x - plane[2] * p.y;
}

#endif
