#include "core/presentation/bent_sheet.h"

#include <errno.h>
#include <stdbool.h>
#include <string.h>

#include "core/landmark/meeting.h"
#include "core/math/solve.h"

enum { POINTS_MIN = 24, KNOTS_MAX = 28, UNKNOWNS_MAX = KNOTS_MAX + 1, ANGLES = 12, PLANE = 3 };

/* Knots of the profile are no closer: a nose's width would be followed by anything finer. */
static const double knot_mm = 12.0;
/* Couples neighbouring knots, weakly: some may have no points. In points. */
static const double stiffness = 0.05;
/* Cut-offs of Tukey's weight, in units of the limit. */
static const double cutoffs[] = {8.0, 4.0, 2.0, 1.0};

enum { STEPS = sizeof cutoffs / sizeof cutoffs[0] };

/* A sheet ruled along one direction. */
struct sheet {
    double cosine, sine, first_mm, spacing_mm;
    int n_knots;
    double x[UNKNOWNS_MAX]; /* heights of the knots, then the slope along the rulings */
};

static double across(const struct sheet *s, struct iso_vec3 p)
{
    return p.x * s->cosine + p.y * s->sine;
}

static double along(const struct sheet *s, struct iso_vec3 p)
{
    return p.y * s->cosine - p.x * s->sine;
}

/* The knot below a point; *part is how far it is to the next one, 0..1. */
static int knot_below(const struct sheet *s, struct iso_vec3 p, double *part)
{
    double at = (across(s, p) - s->first_mm) / s->spacing_mm;
    int k = (int)fmin(fmax(floor(at), 0.0), s->n_knots - 2.0);
    *part = at - k;
    return k;
}

static double above_sheet(const struct sheet *s, struct iso_vec3 p)
{
    double part;
    int k = knot_below(s, p, &part);
    return p.z - (1.0 - part) * s->x[k] - part * s->x[k + 1] - along(s, p) * s->x[s->n_knots];
}

static struct sheet lay_out(const struct iso_vec3 *p, int n, double angle_rad)
{
    struct sheet s = {.cosine = cos(angle_rad), .sine = sin(angle_rad)};
    double low = INFINITY, high = -INFINITY;
    for (int i = 0; i < n; i++) {
        double t = across(&s, p[i]);
        low = fmin(low, t);
        high = fmax(high, t);
    }
    int gaps = (int)fmin(fmax(floor((high - low) / knot_mm), 1.0), KNOTS_MAX - 1.0);
    s.first_mm = low;
    s.spacing_mm = fmax((high - low) / gaps, 1e-6);
    s.n_knots = gaps + 1;
    return s;
}

/* One weighted least-squares step; `cutoff_mm` 0: all weights 1. */
static int solve_sheet(struct sheet *s, const struct iso_vec3 *p, int n, double cutoff_mm)
{
    double h[UNKNOWNS_MAX * UNKNOWNS_MAX] = {0}, g[UNKNOWNS_MAX] = {0};
    int m = s->n_knots + 1, slope = s->n_knots;
    for (int i = 0; i < n; i++) {
        double w = cutoff_mm > 0.0 ? iso_tukey(above_sheet(s, p[i]), cutoff_mm) : 1.0, part;
        if (!(w > 0.0)) {
            continue;
        }
        int k = knot_below(s, p[i], &part);
        double a = 1.0 - part, b = part, c = along(s, p[i]);
        h[k * m + k] += w * a * a;
        h[(k + 1) * m + k] += w * a * b;
        h[(k + 1) * m + k + 1] += w * b * b;
        h[slope * m + k] += w * a * c;
        h[slope * m + k + 1] += w * b * c;
        h[slope * m + slope] += w * c * c;
        g[k] += w * a * p[i].z;
        g[k + 1] += w * b * p[i].z;
        g[slope] += w * c * p[i].z;
    }
    for (int k = 0; k + 1 < s->n_knots; k++) {
        h[k * m + k] += stiffness;
        h[(k + 1) * m + k + 1] += stiffness;
        h[(k + 1) * m + k] -= stiffness;
    }
    if (iso_cholesky_factorise(h, m)) {
        return -ENODATA;
    }
    iso_cholesky_solve(h, m, g);
    memcpy(s->x, g, (size_t)m * sizeof *g);
    return 0;
}

/* Adds one residual to the figures of a fit. */
static void tally(struct iso_sheet_fit *fit, double r, double limit_mm)
{
    fit->rms_mm += fmin(r * r, limit_mm * limit_mm);
    fit->inlier_share += fabs(r) < 0.5 * limit_mm ? 1.0 : 0.0;
}

static void finish(struct iso_sheet_fit *fit, int n)
{
    fit->rms_mm = sqrt(fit->rms_mm / n);
    fit->inlier_share /= n;
}

/* How far the profile leaves the straight line through its ends. */
static double bend_of(const struct sheet *s)
{
    double low = 0.0, high = 0.0, rise = s->x[s->n_knots - 1] - s->x[0];
    for (int k = 0; k < s->n_knots; k++) {
        double off = s->x[k] - s->x[0] - rise * k / (s->n_knots - 1);
        low = fmin(low, off);
        high = fmax(high, off);
    }
    return high - low;
}

static int fit_at_angle(const struct iso_vec3 *p, int n, double limit_mm, double angle_rad,
                        struct iso_sheet_fit *out)
{
    struct sheet sheet = lay_out(p, n, angle_rad);
    int error = solve_sheet(&sheet, p, n, 0.0);
    for (int i = 0; i < STEPS && !error; i++) {
        error = solve_sheet(&sheet, p, n, cutoffs[i] * limit_mm);
    }
    if (error) {
        return error;
    }
    struct iso_sheet_fit fit = {.angle_rad = angle_rad, .bend_mm = bend_of(&sheet)};
    for (int i = 0; i < n; i++) {
        tally(&fit, above_sheet(&sheet, p[i]), limit_mm);
    }
    finish(&fit, n);
    *out = fit;
    return 0;
}

int iso_bent_sheet_fit(const struct iso_vec3 *points_mm, int n, double limit_mm,
                       struct iso_sheet_fit *out)
{
    struct iso_sheet_fit best = {.rms_mm = INFINITY}, fit;
    if (n < POINTS_MIN || n > ISO_SHEET_POINTS_MAX) {
        return -ENODATA;
    }
    for (int k = 0; k < ANGLES; k++) {
        if (!fit_at_angle(points_mm, n, limit_mm, M_PI * k / ANGLES, &fit) &&
            fit.rms_mm < best.rms_mm) {
            best = fit;
        }
    }
    /* A roll of 60 mm that is met 7 degrees off is missed by millimetres: down to 1 degree. */
    for (double turn = 0.5 * M_PI / ANGLES; turn > 0.015; turn *= 0.5) {
        double middle = best.angle_rad;
        for (int side = -1; side <= 1; side += 2) {
            double angle = fmod(middle + side * turn + M_PI, M_PI);
            if (!fit_at_angle(points_mm, n, limit_mm, angle, &fit) && fit.rms_mm < best.rms_mm) {
                best = fit;
            }
        }
    }
    if (!isfinite(best.rms_mm)) {
        return -ENODATA;
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
            double w = step < 0 ? 1.0 : iso_tukey(iso_above_plane(x, points_mm[i]),
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
        tally(&fit, iso_above_plane(x, points_mm[i]), limit_mm);
    }
    finish(&fit, n);
    memcpy(plane, x, sizeof x);
    *out = fit;
    return 0;
}
