#include "core/registration/affine.h"

#include <errno.h>
#include <stddef.h>
#include <string.h>

#include "core/base/solve.h"

struct iso_affine iso_affine_identity(void)
{
    return (struct iso_affine){{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
}

struct iso_affine iso_affine_of_rigid(const struct iso_rigid *rigid)
{
    struct iso_affine a;
    const double t[3] = {rigid->translation_mm.x, rigid->translation_mm.y, rigid->translation_mm.z};
    for (int i = 0; i < 3; i++) {
        memcpy(a.m[i], rigid->rotation.m[i], 3 * sizeof(double));
        a.m[i][3] = t[i];
    }
    return a;
}

int iso_affine_fit(const struct iso_vec3 *source, const struct iso_vec3 *target,
                   const double *weight, int n, struct iso_affine *target_from_source)
{
    double x[16] = {0}, y[3][4] = {{0}};
    int used = 0;
    for (int i = 0; i < n; i++) {
        const double w = weight ? weight[i] : 1.0;
        used += w > 0.0;
        const double s[4] = {source[i].x, source[i].y, source[i].z, 1.0};
        const double t[3] = {target[i].x, target[i].y, target[i].z};
        for (int j = 0; j < 4; j++) {
            for (int k = 0; k < 4; k++) {
                x[4 * j + k] += w * s[j] * s[k];
            }
            for (int k = 0; k < 3; k++) {
                y[k][j] += w * s[j] * t[k];
            }
        }
    }
    if (used < 4) {
        return -EINVAL;
    }
    const int error = iso_cholesky_factorise(x, 4);
    if (error) {
        return error;
    }
    for (int k = 0; k < 3; k++) {
        iso_cholesky_solve(x, 4, y[k]);
        memcpy(target_from_source->m[k], y[k], sizeof y[k]);
    }
    return 0;
}
