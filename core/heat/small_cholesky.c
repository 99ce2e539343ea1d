#include "core/heat/small_cholesky.h"

#include <math.h>
#include <string.h>

enum { N = ISO_PANEL };

static bool factorise(const double (*gram)[N], double scale, double (*u)[N])
{
    for (int j = 0; j < N; j++) {
        for (int i = 0; i <= j; i++) {
            double sum = gram[i][j];
            for (int k = 0; k < i; k++) {
                sum -= u[k][i] * u[k][j];
            }
            if (i < j) {
                u[i][j] = sum / u[i][i];
            } else if (sum > 1e-8 * gram[j][j] && sqrt(sum) > 1e-14 * scale && isfinite(sum)) {
                u[j][j] = sqrt(sum);
            } else {
                return false;
            }
        }
    }
    return true;
}

static void invert(const double (*u)[N], double (*inverse)[N])
{
    for (int j = 0; j < N; j++) {
        inverse[j][j] = 1.0 / u[j][j];
        for (int i = j - 1; i >= 0; i--) {
            double sum = 0.0;
            for (int k = i + 1; k <= j; k++) {
                sum += u[i][k] * inverse[k][j];
            }
            inverse[i][j] = -sum / u[i][i];
        }
    }
}

bool iso_small_cholesky(const double (*gram)[N], double scale, double (*r)[N], double (*inverse)[N])
{
    double u[N][N] = {{0}}, product[N][N] = {{0}};
    if (!factorise(gram, scale, u)) {
        return false;
    }
    memset(inverse, 0, N * sizeof *inverse);
    invert((const double(*)[N])u, inverse);
    for (int i = 0; i < N; i++) {
        for (int j = i; j < N; j++) {
            for (int k = i; k <= j; k++) {
                product[i][j] += u[i][k] * r[k][j];
            }
        }
    }
    memcpy(r, product, sizeof product);
    return true;
}
