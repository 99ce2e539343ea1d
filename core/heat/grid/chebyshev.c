#include "core/heat/grid/chebyshev.h"

#include <errno.h>
#include <math.h>

int iso_chebyshev_exp(double z, double tolerance, double c[ISO_CHEBYSHEV_TERMS_MAX])
{
    /* I_k(z) exp(-z) decreases like exp(-k^2 / 2z) and is negligible at this k. */
    double start = ceil(9.0 * sqrt(z) + 40.0);
    if (!(z > 0.0 && start < ISO_CHEBYSHEV_TERMS_MAX)) {
        return -ERANGE;
    }
    double above = 0.0, at = 1e-250, sum = 0.0;
    int n = (int)start;
    for (int k = n; k >= 0; k--) {
        c[k] = at;
        sum += k > 0 ? 2.0 * at : at;
        const double below = above + 2.0 * k / z * at;
        above = at;
        at = below;
    }
    for (int k = 0; k <= n; k++) {
        c[k] *= (k > 0 ? 2.0 : 1.0) * (k % 2 ? -1.0 : 1.0) / sum;
    }
    double rest = 0.0;
    while (n > 0 && rest + fabs(c[n]) < tolerance) {
        rest += fabs(c[n--]);
    }
    return n + 1;
}
