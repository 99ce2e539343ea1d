/* How well a plane, or a sheet of paper bent any way about one direction, fits a piece of surface.
 *
 * What is printed or shown is flat, or bent: a developable surface, whose Gaussian curvature is 0
 * (do Carmo 1976, sec. 3-3). Rolled, wavy and folded alike about one direction it is a generalised
 * cylinder, over any plane that is not square to it
 *
 *     z = c s + f(t),   t = x cos a + y sin a,   s = y cos a - x sin a,
 *
 * with rulings along s and any profile f: here piecewise linear, so that creases fit as well as
 * rolls. No angle fits a face, whose nose is curved both ways. */
#ifndef ISO_CORE_PRESENTATION_BENT_SHEET_H
#define ISO_CORE_PRESENTATION_BENT_SHEET_H

#include "isotherm/vec.h"

enum { ISO_SHEET_POINTS_MAX = 1024 };

struct iso_sheet_fit {
    double rms_mm;       /* root mean square of residuals, each limited to `limit_mm` */
    double inlier_share; /* of the points, nearer than half of `limit_mm` */
    double bend_mm;      /* range of f(t) - its own straight line; 0 for a plane */
    double angle_rad;    /* a, 0..pi; 0 for a plane */
};

/* The plane z = a + b x + c y (plane = {a, b, c}), and the bent sheet, by iteratively reweighted
 * least squares with Tukey's biweight, so that a finger before the sheet does not matter. Residuals
 * are lengths along z. `n` points, at most ISO_SHEET_POINTS_MAX; -ENODATA if there are fewer than
 * 24 or they do not span a surface. */
int iso_plane_fit(const struct iso_vec3 *points_mm, int n, double limit_mm, double plane[3],
                  struct iso_sheet_fit *out) __attribute__((warn_unused_result));
int iso_bent_sheet_fit(const struct iso_vec3 *points_mm, int n, double limit_mm,
                       struct iso_sheet_fit *out) __attribute__((warn_unused_result));

/* Height of a point over a plane, along z. */
static inline double iso_above_plane(const double plane[3], struct iso_vec3 p)
{
    return p.z - plane[0] - plane[1] * p.x - plane[2] * p.y;
}

#endif
