#include "core/registration/rigid.h"

#include <errno.h>
#include <stddef.h>

enum { JACOBI_SWEEPS_MAX = 32 };

/* Zeroes a[p][q] of a symmetric matrix by one rotation, kept in the columns of v. */
static void jacobi_rotate(double a[4][4], double v[4][4], int p, int q)
{
    const double theta = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
    const double t = copysign(1.0, theta) / (fabs(theta) + sqrt(theta * theta + 1.0));
    double c = 1.0 / sqrt(t * t + 1.0), s = t * c;
    for (int k = 0; k < 4; k++) {
        double kp = a[k][p], kq = a[k][q];
        a[k][p] = c * kp - s * kq;
        a[k][q] = s * kp + c * kq;
    }
    for (int k = 0; k < 4; k++) {
        double pk = a[p][k], qk = a[q][k];
        a[p][k] = c * pk - s * qk;
        a[q][k] = s * pk + c * qk;
    }
    for (int k = 0; k < 4; k++) {
        double kp = v[k][p], kq = v[k][q];
        v[k][p] = c * kp - s * kq;
        v[k][q] = s * kp + c * kq;
    }
}

/* Unit eigenvector of the largest eigenvalue of a symmetric 4x4 matrix, which is destroyed. */
static void principal_eigenvector(double a[4][4], double vector[4])
{
    double v[4][4] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}};
    for (int sweep = 0; sweep < JACOBI_SWEEPS_MAX; sweep++) {
        double off = 0.0, diagonal = 0.0;
        for (int p = 0; p < 4; p++) {
            diagonal += a[p][p] * a[p][p];
            for (int q = p + 1; q < 4; q++) {
                off += a[p][q] * a[p][q];
            }
        }
        if (off <= 1e-30 * diagonal) {
            break;
        }
        for (int p = 0; p < 4; p++) {
            for (int q = p + 1; q < 4; q++) {
                if (a[p][q] != 0.0) {
                    jacobi_rotate(a, v, p, q);
                }
            }
        }
    }
    int best = 0;
    for (int i = 1; i < 4; i++) {
        best = a[i][i] > a[best][best] ? i : best;
    }
    for (int k = 0; k < 4; k++) {
        vector[k] = v[k][best];
    }
}

static struct iso_mat3 rotation_of_quaternion(const double q[4])
{
    double w = q[0], x = q[1], y = q[2], z = q[3];
    return (struct iso_mat3){{
        {w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)},
        {2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)},
        {2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z},
    }};
}

/* Horn's symmetric matrix of the 3x3 cross-covariance s[i][j] = sum w source_i target_j. */
static void horn_matrix(const double s[3][3], double n[4][4])
{
    n[0][0] = s[0][0] + s[1][1] + s[2][2];
    n[1][1] = s[0][0] - s[1][1] - s[2][2];
    n[2][2] = -s[0][0] + s[1][1] - s[2][2];
    n[3][3] = -s[0][0] - s[1][1] + s[2][2];
    n[0][1] = n[1][0] = s[1][2] - s[2][1];
    n[0][2] = n[2][0] = s[2][0] - s[0][2];
    n[0][3] = n[3][0] = s[0][1] - s[1][0];
    n[1][2] = n[2][1] = s[0][1] + s[1][0];
    n[1][3] = n[3][1] = s[2][0] + s[0][2];
    n[2][3] = n[3][2] = s[1][2] + s[2][1];
}

int iso_rigid_sums_centre(struct iso_rigid_sums *sums)
{
    if (sums->used < 3) {
        return -EINVAL;
    }
    sums->source_mean = iso_scale(1.0 / sums->weight, sums->source_mean);
    sums->target_mean = iso_scale(1.0 / sums->weight, sums->target_mean);
    return 0;
}

struct iso_rigid iso_rigid_sums_fit(const struct iso_rigid_sums *sums)
{
    struct iso_rigid fit;
    double h[4][4], quaternion[4];
    horn_matrix(sums->s, h);
    principal_eigenvector(h, quaternion);
    fit.rotation = rotation_of_quaternion(quaternion);
    fit.translation_mm = iso_sub(sums->target_mean,
                                 iso_mat3_apply(&fit.rotation, sums->source_mean));
    return fit;
}

int iso_rigid_fit(const struct iso_vec3 *source, const struct iso_vec3 *target,
                  const double *weight, int n, struct iso_rigid *target_from_source)
{
    struct iso_rigid_sums sums = {.used = 0};
    for (int i = 0; i < n; i++) {
        iso_rigid_sums_first(&sums, source[i], target[i], weight ? weight[i] : 1.0);
    }
    const int error = iso_rigid_sums_centre(&sums);
    if (error) {
        return error;
    }
    for (int i = 0; i < n; i++) {
        iso_rigid_sums_second(&sums, source[i], target[i], weight ? weight[i] : 1.0);
    }
    *target_from_source = iso_rigid_sums_fit(&sums);
    return 0;
}
