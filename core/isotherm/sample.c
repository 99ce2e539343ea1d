#include "isotherm/isotherm_curve.h"

#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "core/isotherm/rays.h"

/* A position relative to the landmark, seen from the front, mm. */
struct place {
    double x, y;
};

static struct place about(struct iso_vec3 point, struct iso_vec3 landmark)
{
    return (struct place){point.x - landmark.x, point.y - landmark.y};
}

static struct iso_vec3 between(struct iso_vec3 a, struct iso_vec3 b, double s)
{
    return iso_madd(a, s, iso_sub(b, a));
}

static int check(struct iso_curve curve, int n_points)
{
    return n_points >= 4 && n_points <= ISO_ISOTHERM_POINTS_MAX && curve.n >= 3 ? 0 : -EINVAL;
}

/* How far a place lies to the left of the line of each ray. */
struct sides {
    iso_pair off[ISO__RAY_PAIRS];
};

void iso__rays_set(struct iso__rays *rays, int n)
{
    memset(rays, 0, sizeof *rays);
    rays->n = n;
    rays->pairs = (n + ISO_PAIR - 1) / ISO_PAIR;
    for (int i = 0; i < n && i < ISO_ISOTHERM_POINTS_MAX; i++) { /* +y, -x: counter-clockwise */
        const double angle = 2.0 * M_PI * i / n;
        rays->x[i / ISO_PAIR][i % ISO_PAIR] = -sin(angle);
        rays->y[i / ISO_PAIR][i % ISO_PAIR] = cos(angle);
    }
}

/* Sets `to` to the sides of a place. Returns whether a line has it on another side than `from`. */
static bool compare_sides(const struct iso__rays *rays, struct place p, const struct sides *from,
                          struct sides *to)
{
    iso_pair_bits changed = {0};
    for (int i = 0; i < rays->pairs; i++) {
        to->off[i] = rays->x[i] * p.y - rays->y[i] * p.x;
        changed |= (from->off[i] < 0.0) ^ (to->off[i] < 0.0);
    }
    return (changed[0] | changed[1]) != 0;
}

/* A segment of a curve. */
struct segment {
    const struct iso_vec3 *from_mm, *to_mm;
    struct place a, b; /* the same from the landmark */
    const struct sides *sides_a, *sides_b;
};

/* Keeps where a segment meets the rays, if this is farther than what the rays met before. */
static void keep_crossings(const struct iso__rays *rays, const struct segment *segment,
                           double farthest[ISO_ISOTHERM_POINTS_MAX], struct iso_isotherm *out)
{
    struct place a = segment->a, b = segment->b;
    for (int i = 0; i < out->n; i++) {
        const double off_a = segment->sides_a->off[i / ISO_PAIR][i % ISO_PAIR];
        const double off_b = segment->sides_b->off[i / ISO_PAIR][i % ISO_PAIR];
        if ((off_a < 0.0) == (off_b < 0.0)) {
            continue;
        }
        const double s = off_a / (off_a - off_b);
        const double x = rays->x[i / ISO_PAIR][i % ISO_PAIR];
        const double y = rays->y[i / ISO_PAIR][i % ISO_PAIR];
        const double reach = x * (a.x + s * (b.x - a.x)) + y * (a.y + s * (b.y - a.y));
        if (reach > farthest[i]) {
            farthest[i] = reach;
            out->points_mm[i] = between(*segment->from_mm, *segment->to_mm, s);
        }
    }
}

int iso__isotherm_sample_rays(struct iso_curve curve, struct iso_vec3 landmark_mm,
                              const struct iso__rays *rays, struct iso_isotherm *out)
{
    const int n_points = rays->n, error = check(curve, n_points);
    if (error) {
        return error;
    }
    out->n = n_points;
    out->closed = curve.closed;
    double farthest[ISO_ISOTHERM_POINTS_MAX];
    for (int i = 0; i < n_points; i++) {
        farthest[i] = -1.0;
    }
    struct sides sides[2] = {{{{0}}}};
    struct place a = about(curve.points_mm[0], landmark_mm);
    (void)compare_sides(rays, a, &sides[1], &sides[0]);
    for (int32_t k = 1; k < curve.n + (curve.closed ? 1 : 0); k++) {
        const struct iso_vec3 *to = &curve.points_mm[k < curve.n ? k : 0];
        const struct place b = about(*to, landmark_mm);
        const struct sides *from = &sides[(k - 1) % 2];
        if (compare_sides(rays, b, from, &sides[k % 2])) {
            const struct segment segment = {&curve.points_mm[k - 1], to, a, b, from, &sides[k % 2]};
            keep_crossings(rays, &segment, farthest, out);
        }
        a = b;
    }
    for (int i = 0; i < n_points; i++) {
        out->weight[i] = farthest[i] > 0.0 ? 1.0f : 0.0f;
        if (!(farthest[i] > 0.0)) {
            out->points_mm[i] = iso_vec3(0, 0, 0);
        }
    }
    return 0;
}

int iso_isotherm_sample_polar(struct iso_curve curve, struct iso_vec3 landmark_mm, int n_points,
                              struct iso_isotherm *out)
{
    struct iso__rays rays;
    const int error = check(curve, n_points);
    if (error) {
        return error;
    }
    iso__rays_set(&rays, n_points);
    return iso__isotherm_sample_rays(curve, landmark_mm, &rays, out);
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
