#include "core/match/upper_surface.h"

#include <errno.h>
#include <math.h>
#include <string.h>

#include "core/base/solve.h"
#include "core/match/upper_face.h"

enum {
    ITERATIONS_MAX = 15,
    COARSE_STRIDE = 4, /* the first steps look at one point in so many */
    COARSE_MAX = 8,    /* steps */
    BINS = 512,
    PAIRS_MIN = 60,
};
static const double trim = 0.8, cutoff_mm = 20.0, lever_mm = 60.0;
static const double step_coarse_mm = 0.1, step_small_mm = 0.05;
static const double overlap_min = 0.3;

/* NaN where the node or a neighbour has no surface. */
static struct iso_upper_node node_of(const struct iso_upper_face *face, int u, int v)
{
    const float pitch_mm = 2.0f * (float)ISO_UPPER_SPACING_MM;
    if (u == 0 || v == 0 || u + 1 == ISO_UPPER_COLUMNS || v + 1 == ISO_UPPER_ROWS ||
        !face->kind[v][u] || !face->kind[v][u - 1] || !face->kind[v][u + 1] ||
        !face->kind[v - 1][u] || !face->kind[v + 1][u]) {
        return (struct iso_upper_node){NAN, NAN, NAN, 0.0f};
    }
    return (struct iso_upper_node){
        .z_mm = face->z_mm[v][u],
        .slope_x = (face->z_mm[v][u + 1] - face->z_mm[v][u - 1]) / pitch_mm,
        .slope_y = (face->z_mm[v - 1][u] - face->z_mm[v + 1][u]) / pitch_mm,
        .measured = face->kind[v][u] == ISO_UPPER_MEASURED,
    };
}

void iso_upper_surface_of(const struct iso_upper_face *face, struct iso_upper_surface *out)
{
    for (int v = 0; v < ISO_UPPER_ROWS; v++) {
        for (int u = 0; u < ISO_UPPER_COLUMNS; u++) {
            out->node[v][u] = node_of(face, u, v);
        }
    }
}

/* The four nodes about a place. The upper left one is in column u and row v. The place lies a share
 * a of the way to the next column, and a share b of the way to the next row. */
struct corner {
    int u, v;
    float a, b;
};

static bool corner_of(double x_mm, double y_mm, struct corner *out)
{
    const double column = ISO_UPPER_MIDDLE + x_mm / ISO_UPPER_SPACING_MM;
    const double row = (ISO_UPPER_TOP_MM - y_mm) / ISO_UPPER_SPACING_MM;
    if (!(column >= 0.0 && row >= 0.0 && column < ISO_UPPER_COLUMNS - 1 &&
          row < ISO_UPPER_ROWS - 1)) {
        return false;
    }
    out->u = (int)column;
    out->v = (int)row;
    out->a = (float)(column - out->u);
    out->b = (float)(row - out->v);
    return true;
}

/* Interpolates between two nodes side by side, c, and the two nodes below them, d. Returns false if
 * one of them has no surface. */
static bool interpolate_nodes(const struct iso_upper_node *c, const struct iso_upper_node *d,
                              const struct corner *corner, struct iso_upper_place *out)
{
    const float a = corner->a, b = corner->b;
    const float w[4] = {(1 - a) * (1 - b), a * (1 - b), (1 - a) * b, a * b};
    const float z_mm = w[0] * c[0].z_mm + w[1] * c[1].z_mm + w[2] * d[0].z_mm + w[3] * d[1].z_mm;
    if (isnan(z_mm)) {
        return false;
    }
    out->z_mm = (double)z_mm;
    out->slope_x = (double)(w[0] * c[0].slope_x + w[1] * c[1].slope_x + w[2] * d[0].slope_x +
                            w[3] * d[1].slope_x);
    out->slope_y = (double)(w[0] * c[0].slope_y + w[1] * c[1].slope_y + w[2] * d[0].slope_y +
                            w[3] * d[1].slope_y);
    out->measured = (double)(w[0] * c[0].measured + w[1] * c[1].measured + w[2] * d[0].measured +
                             w[3] * d[1].measured);
    return true;
}

bool iso_upper_surface_at(const struct iso_upper_surface *surface, double x_mm, double y_mm,
                          struct iso_upper_place *out)
{
    struct corner corner;
    return corner_of(x_mm, y_mm, &corner) &&
           interpolate_nodes(&surface->node[corner.v][corner.u],
                             &surface->node[corner.v + 1][corner.u], &corner, out);
}

bool iso_upper_face_at(const struct iso_upper_face *face, double x_mm, double y_mm,
                       struct iso_upper_place *out)
{
    struct corner at;
    if (!corner_of(x_mm, y_mm, &at)) {
        return false;
    }
    const struct iso_upper_node c[2] = {node_of(face, at.u, at.v), node_of(face, at.u + 1, at.v)};
    const struct iso_upper_node d[2] = {node_of(face, at.u, at.v + 1),
                                        node_of(face, at.u + 1, at.v + 1)};
    return interpolate_nodes(c, d, &at, out);
}

/* Makes a pair of a point and the plane of the surface under it. Returns false where the surface
 * was not measured, or where it lies 20 mm or more from the point. */
static bool pair_up(const struct iso_upper_surface *surface, struct iso_vec3 p,
                    struct iso_upper_pair *pair)
{
    struct iso_upper_place place;
    if (!iso_upper_surface_at(surface, p.x, p.y, &place) || !(place.measured > 0.5)) {
        return false;
    }
    const double scale = 1.0 /
                         sqrt(1.0 + place.slope_x * place.slope_x + place.slope_y * place.slope_y);
    pair->at_mm = p;
    pair->normal = iso_vec3(-place.slope_x * scale, -place.slope_y * scale, scale);
    pair->residual_mm = (p.z - place.z_mm) * scale;
    return fabs(pair->residual_mm) < cutoff_mm;
}

/* Collects every second measured node, like the fields of one colour of a chessboard. */
static int points_of(const struct iso_upper_face *face, struct iso_vec3 *points_mm)
{
    int n = 0;
    for (int v = 0; v < ISO_UPPER_ROWS; v++) {
        for (int u = v % 2; u < ISO_UPPER_COLUMNS; u += 2) {
            if (face->kind[v][u] == ISO_UPPER_MEASURED) {
                points_mm[n++] = iso_vec3(iso_upper_x_mm(u), iso_upper_y_mm(v),
                                          (double)face->z_mm[v][u]);
            }
        }
    }
    return n;
}

/* The distance within which the closest `trim` of the pairs lie, rounded up to a whole bin. */
static double trim_limit(const struct iso_upper_pair *pairs, int n)
{
    int count[BINS] = {0}, wanted = (int)ceil(trim * n);
    for (int i = 0; i < n; i++) {
        count[(int)(fabs(pairs[i].residual_mm) / cutoff_mm * BINS)]++;
    }
    int bin = 0;
    for (int sum = count[0]; sum < wanted && bin + 1 < BINS; sum += count[bin]) {
        bin++;
    }
    return cutoff_mm * (bin + 1) / BINS;
}

/* Finds the small motion x (turn, then shift) that brings the pairs within the limit closest to
 * their planes, to first order (Gauss and Newton). -EDOM if they do not determine it. *rms_mm is
 * their root mean square distance before the motion. */
static int solve_step(const struct iso_upper_pair *pairs, int n, double limit_mm, double x[6],
                      double *rms_mm)
{
    double a[36] = {0.0}, b[6] = {0.0}, sum = 0.0;
    int count = 0;
    for (int i = 0; i < n; i++) {
        const struct iso_upper_pair *p = &pairs[i];
        if (fabs(p->residual_mm) > limit_mm) {
            continue;
        }
        const struct iso_vec3 m = iso_cross(p->at_mm, p->normal);
        const double j[6] = {m.x, m.y, m.z, p->normal.x, p->normal.y, p->normal.z};
        for (int r = 0; r < 6; r++) {
            for (int c = 0; c <= r; c++) {
                a[6 * r + c] += j[r] * j[c];
            }
            b[r] -= j[r] * p->residual_mm;
        }
        sum += p->residual_mm * p->residual_mm;
        count++;
    }
    *rms_mm = sqrt(sum / count);
    const int error = iso_cholesky_factorise(a, 6);
    if (!error) {
        iso_cholesky_solve(a, 6, b);
        memcpy(x, b, sizeof b);
    }
    return error;
}

static int pair_all(struct iso_upper_workspace *work, int n_points, int stride,
                    const struct iso_upper_surface *gallery,
                    const struct iso_rigid *gallery_from_probe)
{
    int n = 0;
    for (int i = 0; i < n_points; i += stride) {
        const struct iso_vec3 p = iso_rigid_apply(gallery_from_probe, work->points_mm[i]);
        n += pair_up(gallery, p, &work->pairs[n]);
    }
    return n;
}

/* Applies the step. Returns how far it moves the face. */
static double move_pose(const double x[6], struct iso_rigid *gallery_from_probe)
{
    const struct iso_vec3 w = iso_vec3(x[0], x[1], x[2]), t = iso_vec3(x[3], x[4], x[5]);
    const struct iso_rigid step = {iso_mat3_rotation(w), t};
    *gallery_from_probe = iso_rigid_mul(&step, gallery_from_probe);
    return iso_norm(t) + lever_mm * iso_norm(w);
}

int iso_upper_fit(struct iso_upper_workspace *work, const struct iso_upper_face *probe,
                  const struct iso_upper_surface *gallery, struct iso_upper_fit *out)
{
    struct iso_upper_fit found = {.gallery_from_probe = iso_rigid_identity()};
    const int n_points = points_of(probe, work->points_mm);
    int stride = COARSE_STRIDE;
    for (int i = 0;; i++) {
        const int n = pair_all(work, n_points, stride, gallery, &found.gallery_from_probe);
        if (stride * n < PAIRS_MIN || stride * n < overlap_min * n_points) {
            return -ENODATA;
        }
        double x[6];
        const double limit_mm = trim_limit(work->pairs, n);
        const int error = solve_step(work->pairs, n, limit_mm, x, &found.rms_mm);
        found.overlap = (double)n / n_points;
        found.iterations = i;
        if (stride == 1 && (error || i == ITERATIONS_MAX)) {
            break;
        }
        const double step_mm = error ? 0.0 : move_pose(x, &found.gallery_from_probe);
        if (stride == 1 && step_mm < step_small_mm) {
            break;
        }
        stride = step_mm < step_coarse_mm || i >= COARSE_MAX ? 1 : stride;
    }
    *out = found;
    return 0;
}
