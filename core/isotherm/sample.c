#include "isotherm/isotherm_curve.h"

#include <errno.h>
#include <math.h>

/* A position relative to the landmark, seen from the front, mm. */
struct place {
    double x, y;
};

static struct place about(struct iso_vec3 point, struct iso_vec3 landmark)
{
    return (struct place){point.x - landmark.x, point.y - landmark.y};
}

/* Where the ray from the origin along the unit direction d meets the segment from a to b. Returns
 * the distance along the ray; negative if the ray does not meet the segment. *s is the share of the
 * segment that lies before the crossing. */
static double meet_ray(struct place d, struct place a, struct place b, double *s)
{
    double across_a = d.x * a.y - d.y * a.x, across_b = d.x * b.y - d.y * b.x;
    if ((across_a < 0.0) == (across_b < 0.0)) {
        return -1.0;
    }
    *s = across_a / (across_a - across_b);
    return d.x * (a.x + *s * (b.x - a.x)) + d.y * (a.y + *s * (b.y - a.y));
}

static struct iso_vec3 between(struct iso_vec3 a, struct iso_vec3 b, double s)
{
    return iso_madd(a, s, iso_sub(b, a));
}

static int check(struct iso_curve curve, int n_points)
{
    return n_points >= 4 && n_points <= ISO_ISOTHERM_POINTS_MAX && curve.n >= 3 ? 0 : -EINVAL;
}

int iso_isotherm_sample_polar(struct iso_curve curve, struct iso_vec3 landmark_mm, int n_points,
                              struct iso_isotherm *out)
{
    const int error = check(curve, n_points);
    if (error) {
        return error;
    }
    out->n = n_points;
    out->closed = curve.closed;
    const int32_t segments = curve.closed ? curve.n : curve.n - 1;
    for (int i = 0; i < n_points; i++) {
        const double angle = 2.0 * M_PI * i / n_points;
        const struct place d = {-sin(angle),
                                cos(angle)}; /* +y, then -x: counter-clockwise from +z */
        double farthest = -1.0;
        out->points_mm[i] = iso_vec3(0, 0, 0);
        for (int32_t k = 0; k < segments; k++) {
            struct iso_vec3 a = curve.points_mm[k], b = curve.points_mm[(k + 1) % curve.n];
            double s = 0.0;
            const double reach = meet_ray(d, about(a, landmark_mm), about(b, landmark_mm), &s);
            if (reach > farthest) {
                farthest = reach;
                out->points_mm[i] = between(a, b, s);
            }
        }
        out->weight[i] = farthest > 0.0 ? 1.0f : 0.0f;
        if (!(farthest > 0.0)) {
            out->points_mm[i] = iso_vec3(0, 0, 0);
        }
    }
    return 0;
}

static double length_of(struct iso_curve curve, int32_t segments)
{
    double length = 0.0;
    for (int32_t k = 0; k < segments; k++) {
        length += iso_norm(iso_sub(curve.points_mm[(k + 1) % curve.n], curve.points_mm[k]));
    }
    return length;
}

/* Twice the area that the curve encloses seen from the front; positive counter-clockwise. */
static double signed_area(struct iso_curve curve, struct iso_vec3 landmark)
{
    double area = 0.0;
    for (int32_t k = 0; k < curve.n; k++) {
        const struct place a = about(curve.points_mm[k], landmark);
        const struct place b = about(curve.points_mm[(k + 1) % curve.n], landmark);
        area += a.x * b.y - a.y * b.x;
    }
    return area;
}

/* The index of the point of the curve whose direction from the landmark is closest to +y. */
static int32_t uppermost(struct iso_curve curve, struct iso_vec3 landmark)
{
    int32_t best = 0;
    double best_cosine = -INFINITY;
    for (int32_t k = 0; k < curve.n; k++) {
        const struct place p = about(curve.points_mm[k], landmark);
        const double cosine = p.y / fmax(hypot(p.x, p.y), 1e-12);
        if (cosine > best_cosine) {
            best_cosine = cosine;
            best = k;
        }
    }
    return best;
}

int iso_isotherm_sample_arc(struct iso_curve curve, struct iso_vec3 landmark_mm, int n_points,
                            struct iso_isotherm *out)
{
    const int error = check(curve, n_points);
    if (error) {
        return error;
    }
    out->n = n_points;
    out->closed = curve.closed;
    int32_t segments = curve.closed ? curve.n : curve.n - 1;
    const int32_t step = signed_area(curve, landmark_mm) >= 0.0 ? 1 : curve.n - 1;
    int32_t at = step == 1 ? 0 : curve.n - 1;
    if (curve.closed) {
        at = uppermost(curve, landmark_mm);
    }
    /* The last point of an open curve is its end; that of a closed curve would be its first point
     * again. */
    const double spacing = length_of(curve, segments) / (curve.closed ? n_points : n_points - 1);
    double walked = 0.0; /* arc length from the start to the point `at` */
    for (int i = 0; i < n_points; i++) {
        int32_t next = (at + step) % curve.n;
        double length = iso_norm(iso_sub(curve.points_mm[next], curve.points_mm[at]));
        while (i * spacing > walked + length && segments > 1) {
            walked += length;
            segments--;
            at = next;
            next = (at + step) % curve.n;
            length = iso_norm(iso_sub(curve.points_mm[next], curve.points_mm[at]));
        }
        const double s = length > 0.0 ? fmin((i * spacing - walked) / length, 1.0) : 0.0;
        out->points_mm[i] = between(curve.points_mm[at], curve.points_mm[next], s);
        out->weight[i] = 1.0f;
    }
    return 0;
}
