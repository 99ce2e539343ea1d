/* Whole-face registration: iterative closest point from point to plane.
 *
 * Besl and McKay 1992; Chen and Medioni 1991 (point to plane); Lu, Jain and Colbry 2006
 * (matching 2.5D face scans: registration from landmarks, then ICP; the remaining distance is
 * the score). Here both faces start in the face frame of the fitted head. The gallery's face is
 * a height field, so that the partner of a probe point is looked up below it and needs no search
 * (projective association: Blais and Levine 1995). The closest 80 % of the pairs count
 * (Chetverikov and others 2002). The distance is the root mean square of the remaining
 * point-to-plane distances. */
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/solve.h"
#include "sim/lab/methods/method.h"

enum {
    STEP_PX = 2, /* every second column and row of the probe: 4 mm */
    ITERATIONS_MAX = 15,
    BINS = 512,
    PAIRS_MIN = 60,
};
static const double trim = 0.8, cutoff_mm = 20.0, step_small_mm = 0.02, lever_mm = 60.0;
static const double overlap_min = 0.3;
/* The upper face ends below the nose. Expressions move it least. */
static const double upper_y_mm = -18.0;

/* A grid point of the height field: z, its slopes, and whether it was measured. */
struct cell {
    float z_mm, slope_x, slope_y, measured;
};

struct surface {
    int side;
    double spacing_mm;
    struct cell *cells; /* [side * side]; z is NAN where the slopes are unknown */
    size_t n_points;
    struct iso_vec3 *points_mm; /* measured ones, every STEP_PX */
};

struct pair {
    struct iso_vec3 at_mm, normal;
    double residual_mm;
};

static void discard_face(void *description)
{
    struct surface *s = description;
    if (s) {
        if (s->cells) {
            explicit_bzero(s->cells, (size_t)s->side * (size_t)s->side * sizeof *s->cells);
        }
        free(s->cells);
        if (s->points_mm) {
            explicit_bzero(s->points_mm, s->n_points * sizeof *s->points_mm);
        }
        free(s->points_mm);
        free(s);
    }
}

static void fill_cells(const struct sim_scan *face, double lowest_mm, struct surface *s)
{
    const int side = face->side;
    const float pitch = 2.0f * (float)face->spacing_mm;
    for (int v = 0; v < side; v++) {
        for (int u = 0; u < side; u++) {
            const int i = v * side + u;
            struct cell *cell = &s->cells[i];
            *cell = (struct cell){NAN, 0.0f, 0.0f, 0.0f};
            if (u == 0 || v == 0 || u + 1 == side || v + 1 == side) {
                continue;
            }
            const float *z = &face->z_mm[i];
            cell->slope_x = (z[1] - z[-1]) / pitch;
            cell->slope_y = (z[-side] - z[side]) / pitch;
            const bool known = !isnan(cell->slope_x) && !isnan(cell->slope_y);
            struct iso_vec3 p = sim_scan_point(face, u, v);
            cell->z_mm = known && p.y >= lowest_mm ? z[0] : NAN;
            cell->measured = face->measured[i];
            const bool sampled = u % STEP_PX == 0 && v % STEP_PX == 0 && face->measured[i];
            if (sampled && !isnan(cell->z_mm)) {
                s->points_mm[s->n_points++] = p;
            }
        }
    }
}

static int describe_from(const struct sim_scan *face, double lowest_mm, void **description)
{
    struct surface *s = calloc(1, sizeof *s);
    if (!s) {
        return -ENOMEM;
    }
    s->side = face->side;
    s->spacing_mm = face->spacing_mm;
    s->cells = calloc(sim_scan_pixels(face), sizeof *s->cells);
    s->points_mm = calloc(sim_scan_pixels(face), sizeof *s->points_mm);
    if (!s->cells || !s->points_mm) {
        discard_face(s);
        return -ENOMEM;
    }
    fill_cells(face, lowest_mm, s);
    if (s->n_points < PAIRS_MIN) {
        discard_face(s);
        return -ENODATA;
    }
    *description = s;
    return 0;
}

static int describe_whole(const void *knowledge, const struct sim_scan *face, void **description)
{
    (void)knowledge;
    return describe_from(face, -INFINITY, description);
}

static int describe_upper(const void *knowledge, const struct sim_scan *face, void **description)
{
    (void)knowledge;
    return describe_from(face, upper_y_mm, description);
}

/* Finds the plane of the height field under a point. Returns false where the field was not
 * measured, or if the point is farther from the plane than cutoff_mm. */
static bool pair_up(const struct surface *s, struct iso_vec3 p, struct pair *pair)
{
    const double middle = (s->side - 1) / 2.0;
    const double column = middle + p.x / s->spacing_mm, row = middle - p.y / s->spacing_mm;
    const int u = (int)column, v = (int)row;
    if (!(column >= 0.0) || !(row >= 0.0) || u + 1 >= s->side || v + 1 >= s->side) {
        return false;
    }
    const float a = (float)(column - u), b = (float)(row - v);
    const struct cell *c = &s->cells[v * s->side + u], *d = c + s->side;
    float w[4] = {(1 - a) * (1 - b), a * (1 - b), (1 - a) * b, a * b};
    const float measured = w[0] * c[0].measured + w[1] * c[1].measured + w[2] * d[0].measured +
                           w[3] * d[1].measured;
    const float z = w[0] * c[0].z_mm + w[1] * c[1].z_mm + w[2] * d[0].z_mm + w[3] * d[1].z_mm;
    if (!(measured > 0.5f) || isnan(z)) {
        return false;
    }
    const float x = w[0] * c[0].slope_x + w[1] * c[1].slope_x + w[2] * d[0].slope_x +
                    w[3] * d[1].slope_x;
    const float y = w[0] * c[0].slope_y + w[1] * c[1].slope_y + w[2] * d[0].slope_y +
                    w[3] * d[1].slope_y;
    const double scale = 1.0 / sqrt(1.0 + (double)(x * x + y * y));
    pair->at_mm = p;
    pair->normal = iso_vec3(-(double)x * scale, -(double)y * scale, scale);
    pair->residual_mm = (p.z - (double)z) * scale;
    return fabs(pair->residual_mm) < cutoff_mm;
}

static size_t pair_all(const struct surface *probe, const struct surface *gallery,
                       const struct iso_rigid *gallery_from_probe, struct pair *pairs)
{
    size_t n = 0;
    for (size_t i = 0; i < probe->n_points; i++) {
        struct iso_vec3 p = iso_rigid_apply(gallery_from_probe, probe->points_mm[i]);
        n += pair_up(gallery, p, &pairs[n]);
    }
    return n;
}

/* The distance that the closest share `trim` of the pairs does not exceed, exact to the width of a
 * bin. */
static double trim_limit(const struct pair *pairs, size_t n)
{
    size_t count[BINS] = {0}, wanted = (size_t)ceil(trim * (double)n), sum = 0;
    for (size_t i = 0; i < n; i++) {
        count[(size_t)(fabs(pairs[i].residual_mm) / cutoff_mm * BINS)]++;
    }
    size_t bin = 0;
    for (sum = count[0]; sum < wanted && bin + 1 < BINS; sum += count[bin]) {
        bin++;
    }
    return cutoff_mm * (double)(bin + 1) / BINS;
}

/* One Gauss-Newton step on the pairs within the limit; -EDOM if it is underdetermined. */
static int solve_step(const struct pair *pairs, size_t n, double limit_mm, double x[6])
{
    double a[36] = {0.0}, b[6] = {0.0};
    for (size_t i = 0; i < n; i++) {
        const struct pair *p = &pairs[i];
        if (fabs(p->residual_mm) > limit_mm) {
            continue;
        }
        struct iso_vec3 m = iso_cross(p->at_mm, p->normal);
        const double j[6] = {m.x, m.y, m.z, p->normal.x, p->normal.y, p->normal.z};
        for (int r = 0; r < 6; r++) {
            for (int c = 0; c <= r; c++) {
                a[6 * r + c] += j[r] * j[c];
            }
            b[r] -= j[r] * p->residual_mm;
        }
    }
    const int error = iso_cholesky_factorise(a, 6);
    if (!error) {
        iso_cholesky_solve(a, 6, b);
        memcpy(x, b, sizeof b);
    }
    return error;
}

static double rms_within(const struct pair *pairs, size_t n, double limit_mm)
{
    double sum = 0.0;
    size_t count = 0;
    for (size_t i = 0; i < n; i++) {
        if (fabs(pairs[i].residual_mm) <= limit_mm) {
            sum += pairs[i].residual_mm * pairs[i].residual_mm;
            count++;
        }
    }
    return sqrt(sum / (double)count);
}

/* Moves the probe step by step; *rms_mm belongs to the last pairing. -ENODATA if too few points
 * have a partner. */
static int register_pair(const struct surface *probe, const struct surface *gallery,
                         struct pair *pairs, double *rms_mm)
{
    struct iso_rigid gallery_from_probe = iso_rigid_identity();
    for (int i = 0;; i++) {
        const size_t n = pair_all(probe, gallery, &gallery_from_probe, pairs);
        if (n < PAIRS_MIN || (double)n < overlap_min * (double)probe->n_points) {
            return -ENODATA;
        }
        double limit_mm = trim_limit(pairs, n), x[6];
        *rms_mm = rms_within(pairs, n, limit_mm);
        if (i == ITERATIONS_MAX || solve_step(pairs, n, limit_mm, x)) {
            return 0;
        }
        struct iso_vec3 w = iso_vec3(x[0], x[1], x[2]), t = iso_vec3(x[3], x[4], x[5]);
        struct iso_rigid step = {iso_mat3_rotation(w), t};
        gallery_from_probe = iso_rigid_mul(&step, &gallery_from_probe);
        if (iso_norm(t) + lever_mm * iso_norm(w) < step_small_mm) {
            return 0;
        }
    }
}

static int distance_between(const void *knowledge, const void *probe, const void *gallery,
                            double *out)
{
    (void)knowledge;
    const struct surface *p = probe, *g = gallery;
    struct pair *pairs = calloc(p->n_points, sizeof *pairs);
    if (!pairs) {
        return -ENOMEM;
    }
    double rms_mm;
    const int error = register_pair(p, g, pairs, &rms_mm);
    free(pairs);
    if (!error) {
        *out = rms_mm;
    }
    return error;
}

const struct sim_method sim_method_icp = {
    .name = "icp",
    .source = "Lu, Jain and Colbry 2006: whole-face ICP; here point to plane, trimmed, from the "
              "fitted pose",
    .describe = describe_whole,
    .discard = discard_face,
    .distance = distance_between,
};

const struct sim_method sim_method_icp_upper = {
    .name = "icp-upper",
    .source = "the same on the face above the upper lip (Chang, Bowyer and Flynn 2006: what "
              "expressions move least)",
    .describe = describe_upper,
    .discard = discard_face,
    .distance = distance_between,
};
