#include "core/presentation/bent_sheet.h"

#include <errno.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>

#include "core/base/lanes.h"
#include "core/base/solve.h"
#include "core/landmark/meeting.h"

enum { POINTS_MIN = 24, KNOTS_MAX = 28, UNKNOWNS_MAX = KNOTS_MAX + 1, ANGLES = 10, PLANE = 3 };

/* The least distance of the knots of the profile. A finer profile would follow a nose. */
static const double knot_mm = 12.0;
/* The weight of the coupling of neighbouring knots, compared with a point. Without it a knot that
 * has no points of its own would be undetermined. */
static const double stiffness = 0.05;
/* The cut-offs of Tukey's weight in the reweighted steps, in units of the limit. The step before
 * them has no weights. The angles are compared after the first STEPS_COMPARED of these steps. */
static const double cutoffs[] = {8.0, 4.0, 2.0, 1.0};

enum { STEPS = sizeof cutoffs / sizeof cutoffs[0], STEPS_COMPARED = 2 };

/* A sheet that is ruled along one direction, and the points in its coordinates. */
struct sheet {
    const struct iso_vec3 *point_mm;
    int n, n_knots;
    double cosine, sine;    /* of the direction across the rulings */
    double x[UNKNOWNS_MAX]; /* heights of the knots, then the slope along the rulings */
    uint8_t below[ISO_SHEET_POINTS_MAX]; /* [n]: the knot before each point */
    /* [n]: how far the point lies on the way to the next, 0..1. */
    double part[ISO_SHEET_POINTS_MAX];
};

/* The coordinate of a point along the rulings. */
static double along_mm(const struct sheet *s, int i)
{
    return s->point_mm[i].y * s->cosine - s->point_mm[i].x * s->sine;
}

static void lay_out(const struct iso_vec3 *p, int n, double angle_rad, struct sheet *s)
{
    double low = INFINITY, high = -INFINITY;
    s->point_mm = p;
    s->n = n;
    s->cosine = cos(angle_rad);
    s->sine = sin(angle_rad);
    for (int i = 0; i < n; i++) {
        const double t = p[i].x * s->cosine + p[i].y * s->sine;
        s->part[i] = t;
        low = t < low ? t : low;
        high = t > high ? t : high;
    }
    const double gaps = fmin(fmax(floor((high - low) / knot_mm), 1.0), KNOTS_MAX - 1.0);
    const double spacing_mm = fmax((high - low) / gaps, 1e-6);
    s->n_knots = (int)gaps + 1;
    for (int i = 0; i < n; i++) {
        const double at = (s->part[i] - low) / spacing_mm;
        const int k = (int)at < s->n_knots - 2 ? (int)at : s->n_knots - 2;
        s->below[i] = (uint8_t)k;
        s->part[i] = at - k;
    }
}

static double above_sheet(const struct sheet *s, int i)
{
    const int k = s->below[i];
    return s->point_mm[i].z - s->x[k] - s->part[i] * (s->x[k + 1] - s->x[k]) -
           along_mm(s, i) * s->x[s->n_knots];
}

/* What the points between two knots add to the equations. Each pair has a number for the knot
 * before them and one for the knot behind them: the sums of their shares of the weights, and the
 * sums of these shares multiplied by the distance from the knot before (`part`), the coordinate
 * along the rulings, and the height. */
struct between {
    iso_pair share, part, along, height;
};

/* Adds up the points with their weights. With a `cutoff_mm` of 0 all weights are 1. Returns the
 * sums of the squares along the rulings, and of these coordinates times the heights. */
static iso_pair add_points(const struct sheet *s, double cutoff_mm, struct between *between)
{
    iso_pair slope = {0};
    for (int i = 0; i < s->n; i++) {
        const double w = cutoff_mm > 0.0 ? iso_tukey(above_sheet(s, i), cutoff_mm) : 1.0;
        const double b = w * s->part[i], c = along_mm(s, i), z = s->point_mm[i].z;
        const iso_pair share = {w - b, b};
        struct between *at = &between[s->below[i]];
        at->share += share;
        at->part += share * s->part[i];
        at->along += share * c;
        at->height += share * z;
        slope += w * c * (iso_pair){c, z};
    }
    return slope;
}

/* One weighted least-squares step. It must not be inlined: its matrix would be added to a stack
 * frame of more than 16 KiB that holds the points. */
__attribute__((noinline)) static int solve_sheet(struct sheet *s, double cutoff_mm)
{
    double h[UNKNOWNS_MAX * UNKNOWNS_MAX], g[UNKNOWNS_MAX] = {0};
    struct between between[KNOTS_MAX];
    const int m = s->n_knots + 1, slope = s->n_knots;
    memset(h, 0, (size_t)(m * m) * sizeof *h);
    memset(between, 0, (size_t)s->n_knots * sizeof *between);
    const iso_pair of_slope = add_points(s, cutoff_mm, between);
    h[slope * m + slope] = of_slope[0];
    g[slope] = of_slope[1];
    for (int k = 0; k + 1 < s->n_knots; k++) {
        const struct between *at = &between[k];
        double *row = &h[k * m + k];
        row[0] += at->share[0] - at->part[0] + stiffness;
        row[m] += at->part[0] - stiffness;
        row[m + 1] += at->part[1] + stiffness;
        for (int end = 0; end < ISO_PAIR; end++) {
            h[slope * m + k + end] += at->along[end];
            g[k + end] += at->height[end];
        }
    }
    if (iso_cholesky_factorise(h, m)) {
        return -ENODATA;
    }
    iso_cholesky_solve(h, m, g);
    memcpy(s->x, g, (size_t)m * sizeof *g);
    return 0;
}

/* Adds one residual to the figures of a fit. */
static void add_residual(struct iso_sheet_fit *fit, double r, double limit_mm)
{
    const double size = fabs(r);
    fit->rms_mm += size < limit_mm ? r * r : limit_mm * limit_mm;
    fit->inlier_share += size < 0.5 * limit_mm ? 1.0 : 0.0;
}

static void finish_fit(struct iso_sheet_fit *fit, int n)
{
    fit->rms_mm = sqrt(fit->rms_mm / n);
    fit->inlier_share /= n;
}

/* How far the profile departs from the straight line through its ends. */
static double bend_of(const struct sheet *s)
{
    double low = 0.0, high = 0.0, rise = s->x[s->n_knots - 1] - s->x[0];
    for (int k = 0; k < s->n_knots; k++) {
        const double off = s->x[k] - s->x[0] - rise * k / (s->n_knots - 1);
        /* Not fmin() and fmax(): gcc 12.2 for arm64 fails on them here at -O3. */
        low = off < low ? off : low;
        high = off > high ? off : high;
    }
    return high - low;
}

/* Fits the sheet whose rulings are perpendicular to the direction angle_rad, with this many
 * reweighted steps. */
static int fit_at_angle(const struct iso_vec3 *p, int n, double limit_mm, double angle_rad,
                        int steps, struct iso_sheet_fit *out)
{
    struct sheet sheet;
    lay_out(p, n, angle_rad, &sheet);
    int error = solve_sheet(&sheet, 0.0);
    for (int i = 0; i < steps && !error; i++) {
        error = solve_sheet(&sheet, cutoffs[i] * limit_mm);
    }
    if (error) {
        return error;
    }
    struct iso_sheet_fit fit = {.angle_rad = angle_rad, .bend_mm = bend_of(&sheet)};
    const double limit = steps < STEPS ? cutoffs[steps] * limit_mm : limit_mm;
    for (int i = 0; i < n; i++) {
        add_residual(&fit, above_sheet(&sheet, i), limit);
    }
    finish_fit(&fit, n);
    *out = fit;
    return 0;
}

/* Tries the two angles that differ by `turn` from the best one, and keeps the best of the three. */
static void refine_turn(const struct iso_vec3 *points_mm, int n, double limit_mm, double turn,
                        struct iso_sheet_fit *best)
{
    const double middle = best->angle_rad;
    for (int side = -1; side <= 1; side += 2) {
        struct iso_sheet_fit fit;
        const double angle = fmod(middle + side * turn + M_PI, M_PI);
        if (!fit_at_angle(points_mm, n, limit_mm, angle, STEPS, &fit) &&
            fit.rms_mm < best->rms_mm) {
            *best = fit;
        }
    }
}

int iso_bent_sheet_fit(const struct iso_vec3 *points_mm, int n, double limit_mm,
                       struct iso_sheet_fit *out)
{
    struct iso_sheet_fit best = {.rms_mm = INFINITY}, fit;
    if (n < POINTS_MIN || n > ISO_SHEET_POINTS_MAX) {
        return -ENODATA;
    }
    for (int k = 0; k < ANGLES; k++) {
        if (!fit_at_angle(points_mm, n, limit_mm, M_PI * k / ANGLES, STEPS_COMPARED, &fit) &&
            fit.rms_mm < best.rms_mm) {
            best = fit;
        }
    }
    if (!isfinite(best.rms_mm) ||
        fit_at_angle(points_mm, n, limit_mm, best.angle_rad, STEPS, &best)) {
        return -ENODATA;
    }
    /* A roll of 60 mm radius whose angle is wrong by 7 degrees leaves residuals of millimetres, so
     * that the angle is found to 1 degree. */
    for (double turn = 0.5 * M_PI / ANGLES; turn > 0.015; turn *= 0.5) {
        refine_turn(points_mm, n, limit_mm, turn, &best);
    }
    *out = best;
    return 0;
}

int iso_plane_fit(const struct iso_vec3 *points_mm, int n, double limit_mm, double plane[3],
                  struct iso_sheet_fit *out)
{
    double x[PLANE] = {0};
    if (n < POINTS_MIN || n > ISO_SHEET_POINTS_MAX) {
        return -ENODATA;
    }
    for (int step = -1; step < STEPS; step++) {
        double h[PLANE * PLANE] = {0}, g[PLANE] = {0};
        for (int i = 0; i < n; i++) {
            const double w = step < 0 ? 1.0
                                      : iso_tukey(iso_above_plane(x, points_mm[i]),
                                                  cutoffs[step] * limit_mm);
            const double j[PLANE] = {1.0, points_mm[i].x, points_mm[i].y};
            for (int a = 0; a < PLANE; a++) {
                for (int b = 0; b <= a; b++) {
                    h[a * PLANE + b] += w * j[a] * j[b];
                }
                g[a] += w * j[a] * points_mm[i].z;
            }
        }
        if (iso_cholesky_factorise(h, PLANE)) {
            return -ENODATA;
        }
        iso_cholesky_solve(h, PLANE, g);
        memcpy(x, g, sizeof x);
    }
    struct iso_sheet_fit fit = {0};
    for (int i = 0; i < n; i++) {
        add_residual(&fit, iso_above_plane(x, points_mm[i]), limit_mm);
    }
    finish_fit(&fit, n);
    memcpy(plane, x, sizeof x);
    *out = fit;
    return 0;
}
