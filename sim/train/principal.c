#include "sim/train/principal.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/solve.h"

static double off_diagonal(const double *a, uint32_t n)
{
    double sum = 0.0;
    for (uint32_t i = 0; i < n; i++) {
        for (uint32_t j = 0; j < i; j++) {
            sum += a[i * n + j] * a[i * n + j];
        }
    }
    return sum;
}

/* Rotates rows p and q by the angle of cosine c and sine s. */
static void rotate_rows(double *m, uint32_t n, uint32_t p, uint32_t q, double c, double s)
{
    for (uint32_t k = 0; k < n; k++) {
        const double x = m[p * n + k], y = m[q * n + k];
        m[p * n + k] = c * x - s * y;
        m[q * n + k] = s * x + c * y;
    }
}

static void rotate_columns(double *m, uint32_t n, uint32_t p, uint32_t q, double c, double s)
{
    for (uint32_t k = 0; k < n; k++) {
        const double x = m[k * n + p], y = m[k * n + q];
        m[k * n + p] = c * x - s * y;
        m[k * n + q] = s * x + c * y;
    }
}

static void sort_falling(uint32_t n, double *value, double *vector)
{
    for (uint32_t i = 0; i < n; i++) {
        uint32_t largest = i;
        for (uint32_t j = i + 1; j < n; j++) {
            largest = value[j] > value[largest] ? j : largest;
        }
        if (largest == i) {
            continue;
        }
        double v = value[i];
        value[i] = value[largest];
        value[largest] = v;
        for (uint32_t k = 0; k < n; k++) {
            v = vector[i * n + k];
            vector[i * n + k] = vector[largest * n + k];
            vector[largest * n + k] = v;
        }
    }
}

void sim_symmetric_eigen(double *a, uint32_t n, double *value, double *vector)
{
    enum { SWEEPS_MAX = 50 };
    double trace = 0.0;
    memset(vector, 0, (size_t)n * n * sizeof *vector);
    for (uint32_t i = 0; i < n; i++) {
        vector[i * n + i] = 1.0;
        trace += fabs(a[i * n + i]);
    }
    for (int sweep = 0; sweep < SWEEPS_MAX && off_diagonal(a, n) > 1e-26 * trace * trace; sweep++) {
        for (uint32_t p = 0; p + 1 < n; p++) {
            for (uint32_t q = p + 1; q < n; q++) {
                if (a[p * n + q] == 0.0) {
                    continue;
                }
                const double tau = (a[q * n + q] - a[p * n + p]) / (2.0 * a[p * n + q]);
                const double t = copysign(1.0, tau) / (fabs(tau) + sqrt(1.0 + tau * tau));
                const double c = 1.0 / sqrt(1.0 + t * t), s = t * c;
                rotate_columns(a, n, p, q, c, s);
                rotate_rows(a, n, p, q, c, s);
                rotate_rows(vector, n, p, q, c, s);
            }
        }
    }
    for (uint32_t i = 0; i < n; i++) {
        value[i] = a[i * n + i];
    }
    sort_falling(n, value, vector);
}

/* The six rigid motions of a point, as displacements: three translations, then rotations about the
 * axes through the origin. */
static void rigid_motions(struct iso_vec3 p, double motion[6][3])
{
    const double m[6][3] = {{1, 0, 0},      {0, 1, 0},      {0, 0, 1},
                            {0, -p.z, p.y}, {p.z, 0, -p.x}, {-p.y, p.x, 0}};
    memcpy(motion, m, sizeof m);
}

static double dot_of_three(const double *a, const double *b)
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

int sim_remove_rigid(const struct iso_vec3 *mean_mm, uint32_t n_vertices, const double *weight,
                     uint32_t n_fields, float *fields_mm)
{
    double normal[36] = {0.0}, motion[6][3];
    for (uint32_t i = 0; i < n_vertices; i++) {
        rigid_motions(mean_mm[i], motion);
        for (int r = 0; r < 36; r++) {
            normal[r] += weight[i] * dot_of_three(motion[r / 6], motion[r % 6]);
        }
    }
    const int error = iso_cholesky_factorise(normal, 6);
    if (error) {
        return error;
    }
    for (uint32_t f = 0; f < n_fields; f++) {
        float *field = fields_mm + (size_t)f * n_vertices * 3;
        double amount[6] = {0.0};
        for (uint32_t i = 0; i < n_vertices; i++) {
            const float *d = field + 3 * (size_t)i;
            const double displacement[3] = {(double)d[0], (double)d[1], (double)d[2]};
            rigid_motions(mean_mm[i], motion);
            for (int r = 0; r < 6; r++) {
                amount[r] += weight[i] * dot_of_three(motion[r], displacement);
            }
        }
        iso_cholesky_solve(normal, 6, amount);
        for (uint32_t i = 0; i < n_vertices; i++) {
            rigid_motions(mean_mm[i], motion);
            for (int k = 0; k < 3; k++) {
                double sum = 0.0;
                for (int r = 0; r < 6; r++) {
                    sum += amount[r] * motion[r][k];
                }
                field[3 * (size_t)i + (size_t)k] -= (float)sum;
            }
        }
    }
    return 0;
}

/* out[k] = sum_i factor[k][i] field[i] */
static void combine_fields(const float *fields, uint32_t n_fields, size_t n_values,
                           const double *factor, uint32_t n_out, float *out)
{
    for (uint32_t k = 0; k < n_out; k++) {
        for (size_t j = 0; j < n_values; j++) {
            double sum = 0.0;
            for (uint32_t i = 0; i < n_fields; i++) {
                sum += factor[k * n_fields + i] * (double)fields[i * n_values + j];
            }
            out[k * n_values + j] = (float)sum;
        }
    }
}

static void weighted_gram(const float *fields, uint32_t n_fields, uint32_t n_vertices,
                          const double *weight, double *gram)
{
    const size_t n_values = 3 * (size_t)n_vertices;
    for (uint32_t i = 0; i < n_fields; i++) {
        for (uint32_t j = 0; j <= i; j++) {
            const float *a = fields + i * n_values, *b = fields + j * n_values;
            double sum = 0.0;
            for (uint32_t v = 0; v < n_vertices; v++, a += 3, b += 3) {
                sum += weight[v] * (double)(a[0] * b[0] + a[1] * b[1] + a[2] * b[2]);
            }
            gram[i * n_fields + j] = gram[j * n_fields + i] = sum;
        }
    }
}

/* Replaces the rows of `factor` by the eigenvectors of `moment` times the roots of their
 * eigenvalues. The fields that they combine then have independent coefficients of variance 1. */
static void factorise_moment(const double *moment, uint32_t n, double *scratch, double *factor)
{
    double value[SIM_FIELDS_MAX];
    memcpy(scratch, moment, (size_t)n * n * sizeof *scratch);
    sim_symmetric_eigen(scratch, n, value, factor);
    for (uint32_t k = 0; k < n; k++) {
        for (uint32_t i = 0; i < n; i++) {
            factor[k * n + i] *= sqrt(fmax(value[k], 0.0));
        }
    }
}

/* The sign of a component is arbitrary, so make its largest value positive. */
static void fix_sign(float *component, size_t n_values)
{
    size_t largest = 0;
    for (size_t j = 1; j < n_values; j++) {
        largest = fabsf(component[j]) > fabsf(component[largest]) ? j : largest;
    }
    const float sign = component[largest] < 0.0f ? -1.0f : 1.0f;
    for (size_t j = 0; j < n_values; j++) {
        component[j] *= sign;
    }
}

int sim_principal(const float *fields_mm, uint32_t n_fields, uint32_t n_vertices,
                  const double *weight, const double *moment, uint32_t n_keep, float *components_mm,
                  double *variance)
{
    if (n_fields > SIM_FIELDS_MAX || n_keep > n_fields) {
        return -EINVAL;
    }
    const size_t n_values = 3 * (size_t)n_vertices, n_square = (size_t)n_fields * n_fields;
    double *gram = calloc(n_square, sizeof *gram), *vector = calloc(n_square, sizeof *vector);
    float *independent = calloc(n_fields * n_values, sizeof *independent);
    const int error = gram && vector && independent ? 0 : -ENOMEM;
    if (!error) {
        const float *fields = fields_mm;
        if (moment) {
            factorise_moment(moment, n_fields, gram, vector);
            combine_fields(fields_mm, n_fields, n_values, vector, n_fields, independent);
            fields = independent;
        }
        weighted_gram(fields, n_fields, n_vertices, weight, gram);
        sim_symmetric_eigen(gram, n_fields, variance, vector);
        combine_fields(fields, n_fields, n_values, vector, n_keep, components_mm);
        for (uint32_t k = 0; k < n_keep; k++) {
            fix_sign(components_mm + k * n_values, n_values);
        }
    }
    free(independent);
    free(vector);
    free(gram);
    return error;
}
