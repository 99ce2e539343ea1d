/* The score of a person of the site without shares of some people in the offset.
 *
 * In the adapted coordinates the covariance within a person is W = I, which contains u u' for the
 * offset u of all people. Without some people it is W = I + U C U' with U = [u, v] and
 * C = diag(-1, 1), where v is the offset of the others. All covariances of the score
 * (iso_metric_score) are then a diagonal matrix and one of low rank:
 *
 *     E = B + w W                        of the mean of the person's templates,
 *     probe of anybody: x W + B,
 *     probe of the person: x W + B - B inv(E) B, around B inv(E) times that mean,
 *
 * The inverse and the determinant of such a matrix need only a matrix with two or four rows
 * (Woodbury 1950). */
#include <lapacke.h>
#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "core/match/site.h"

enum {
    N = ISO_METRIC_DIMENSIONS_MAX,
    RANK = 4,
    GROUPS = 4, /* of people, one of which is left out at a time */
};

/* The matrix diag(d) + Z K Z' of n rows, with `rank` columns of Z. K is symmetric. */
struct covariance {
    int n, rank;
    double d[N], z[RANK][N], k[RANK][RANK];
    double m[RANK][RANK]; /* inv(I + K G) K with G = Z' inv(diag d) Z; the inverse of the matrix is
                             inv(D) - inv(D) Z m Z' inv(D) */
    double log_volume;    /* the logarithm of the determinant */
};

/* Numbers of an inversion. They are made from faces. */
struct inversion {
    double g[RANK][RANK], a[RANK * RANK], b[RANK * RANK]; /* a, b: by columns */
};

/* Fills in I + K G and K. */
static void begin_inversion(const struct covariance *c, struct inversion *x)
{
    const int rank = c->rank;
    for (int i = 0; i < rank; i++) {
        for (int j = 0; j < rank; j++) {
            x->g[i][j] = 0.0;
            for (int d = 0; d < c->n; d++) {
                x->g[i][j] += c->z[i][d] * c->z[j][d] / c->d[d];
            }
        }
    }
    for (int i = 0; i < rank; i++) {
        for (int j = 0; j < rank; j++) {
            x->a[j * rank + i] = i == j ? 1.0 : 0.0;
            for (int l = 0; l < rank; l++) {
                x->a[j * rank + i] += c->k[i][l] * x->g[l][j];
            }
            x->b[j * rank + i] = c->k[i][j];
        }
    }
}

/* Computes m and log_volume. False if the determinant is not positive. */
static bool invert(struct covariance *c)
{
    const int rank = c->rank;
    struct inversion x;
    lapack_int pivot[RANK];
    double volume = 1.0;
    begin_inversion(c, &x);
    const bool solved = LAPACKE_dgesv(LAPACK_COL_MAJOR, rank, rank, x.a, rank, pivot, x.b, rank) ==
                        0;
    for (int i = 0; solved && i < rank; i++) {
        volume *= pivot[i] == i + 1 ? x.a[i * rank + i] : -x.a[i * rank + i];
        for (int j = 0; j < rank; j++) {
            c->m[i][j] = x.b[j * rank + i];
        }
    }
    explicit_bzero(&x, sizeof x);
    if (!solved) {
        return false;
    }
    c->log_volume = log(volume);
    for (int d = 0; d < c->n; d++) {
        c->log_volume += log(c->d[d]);
    }
    return volume > 0.0;
}

/* Computes m Z' inv(D) x. */
static void project(const struct covariance *c, const double *x, double *out)
{
    double zx[RANK];
    for (int i = 0; i < c->rank; i++) {
        zx[i] = 0.0;
        for (int d = 0; d < c->n; d++) {
            zx[i] += c->z[i][d] * x[d] / c->d[d];
        }
    }
    for (int i = 0; i < c->rank; i++) {
        out[i] = 0.0;
        for (int j = 0; j < c->rank; j++) {
            out[i] += c->m[i][j] * zx[j];
        }
    }
    explicit_bzero(zx, sizeof zx);
}

/* The squared length of x by the covariance, and the logarithm of its determinant. */
static double unlikeliness(const struct covariance *c, const double *x)
{
    double sum = c->log_volume, part[RANK];
    project(c, x, part);
    for (int d = 0; d < c->n; d++) {
        double y = x[d];
        for (int i = 0; i < c->rank; i++) {
            y -= c->z[i][d] * part[i];
        }
        sum += x[d] * y / c->d[d];
    }
    explicit_bzero(part, sizeof part);
    return sum;
}

/* People whose shares are left out of the offset. */
struct left_out {
    int people;
    double sum[N]; /* of their means, as they count in the offset */
};

static void leave_out(const struct iso_site_metric *adapted, int person, struct left_out *out)
{
    for (int d = 0; d < adapted->n; d++) {
        out->sum[d] += (double)adapted->own[(size_t)person * (size_t)adapted->n + (size_t)d];
    }
    out->people++;
}

/* Returns the place of a person among those with an own share; -1 if the person has none. */
static int own_place(const struct iso_site_metric *adapted, int64_t number)
{
    int low = 0, high = adapted->n_own;
    while (low < high) {
        const int middle = (low + high) / 2;
        if (adapted->number[middle] < number) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    return low < adapted->n_own && adapted->number[low] == number ? low : -1;
}

/* Sets U. */
static void set_offsets(const struct iso_site_metric *adapted, const struct left_out *out,
                        struct covariance *c)
{
    const double n = (double)adapted->people + 1.0;
    for (int d = 0; d < c->n; d++) {
        const double u = (double)adapted->offset[d];
        c->z[0][d] = u;
        c->z[1][d] = (n * u - out->sum[d]) / (n - out->people);
    }
}

/* Sets `times` W: the rank, and K = times C. The caller sets the diagonal. */
static void set_within(double times, struct covariance *c)
{
    c->rank = 2;
    memset(c->k, 0, sizeof c->k);
    c->k[0][0] = -times;
    c->k[1][1] = times;
}

/* Computes the expected probe of a person, and its covariance for a probe of variance `own`. */
static bool expect_probe(const struct iso_site_metric *adapted,
                         const struct iso_metric_vector *person, double own, struct covariance *c,
                         double *expected)
{
    const double w = iso_metric_variance(person->step);
    double x[N], part[RANK], m[2][2];
    set_within(w, c);
    for (int d = 0; d < c->n; d++) {
        x[d] = (double)(person->scale * person->mean[d]);
        c->d[d] = (double)adapted->metric->between[d] + w;
    }
    if (!invert(c)) {
        explicit_bzero(x, sizeof x);
        return false;
    }
    project(c, x, part);
    memcpy(m[0], c->m[0], sizeof m[0]);
    memcpy(m[1], c->m[1], sizeof m[1]);
    set_within(own, c);
    c->rank = RANK;
    for (int i = 0; i < 2; i++) {
        for (int j = 0; j < 2; j++) {
            c->k[2 + i][2 + j] = m[i][j];
        }
    }
    for (int d = 0; d < c->n; d++) {
        const double b = (double)adapted->metric->between[d], shrink = b / (b + w);
        expected[d] = shrink * (x[d] - c->z[0][d] * part[0] - c->z[1][d] * part[1]);
        c->z[2][d] = shrink * c->z[0][d];
        c->z[3][d] = shrink * c->z[1][d];
        c->d[d] = own + shrink * w;
    }
    explicit_bzero(x, sizeof x);
    explicit_bzero(part, sizeof part);
    explicit_bzero(m, sizeof m);
    return invert(c);
}

/* Computes the logarithm of the likelihood ratio. */
static bool compare(const struct iso_site_metric *adapted, const struct left_out *out,
                    const struct iso_metric_vector *person, const struct iso_metric_vector *probe,
                    double *ratio)
{
    const double own = iso_metric_variance(probe->step);
    struct covariance c = {.n = adapted->n};
    double x[N] = {0}, off[N] = {0};
    set_offsets(adapted, out, &c);
    bool known = expect_probe(adapted, person, own, &c, off);
    for (int d = 0; d < c.n; d++) {
        x[d] = (double)(probe->scale * probe->mean[d]);
        off[d] = x[d] - off[d];
    }
    *ratio = known ? -0.5 * unlikeliness(&c, off) : 0.0;
    set_within(own, &c);
    for (int d = 0; d < c.n; d++) {
        c.d[d] = own + (double)adapted->metric->between[d];
    }
    known = known && invert(&c);
    *ratio += known ? 0.5 * unlikeliness(&c, x) : 0.0;
    explicit_bzero(&c, sizeof c);
    explicit_bzero(x, sizeof x);
    explicit_bzero(off, sizeof off);
    return known;
}

/* Leaves out the person `own`, unless it is -1, and group g of the people. */
static void leave_out_group(const struct iso_site_metric *adapted, int own, int g, int groups,
                            struct left_out *out)
{
    if (own >= 0) {
        leave_out(adapted, own, out);
    }
    for (int p = g * adapted->n_own / groups; p < (g + 1) * adapted->n_own / groups; p++) {
        if (p != own) {
            leave_out(adapted, p, out);
        }
    }
}

double iso_site_score(const struct iso_site_metric *adapted, int64_t number,
                      const struct iso_metric_vector *person, const struct iso_metric_vector *probe)
{
    const int own = own_place(adapted, number);
    const int groups = adapted->n_own < GROUPS ? adapted->n_own : GROUPS;
    double least = INFINITY, ratio;
    if (person->n < 1 || probe->n < 1 || groups == 0) {
        return iso_metric_score(adapted->metric, person, probe);
    }
    for (int g = 0; g < groups; g++) {
        struct left_out out = {.people = 0};
        leave_out_group(adapted, own, g, groups, &out);
        const bool known = compare(adapted, &out, person, probe, &ratio);
        explicit_bzero(&out, sizeof out);
        if (!known || !isfinite(ratio)) {
            return -INFINITY; /* a score that cannot be computed admits nobody */
        }
        least = fmin(least, ratio);
    }
    return (double)adapted->metric->gain * least + (double)adapted->metric->bias;
}
