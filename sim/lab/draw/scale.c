#include "sim/lab/draw/scale.h"

#include <math.h>
#include <stdio.h>

/* The polynomial c[0] + c[1] x + ... of n coefficients. */
static double polynomial(const double *c, int n, double x)
{
    double y = 0.0;
    for (int i = n - 1; i >= 0; i--) {
        y = y * x + c[i];
    }
    return y;
}

double sim_normal_quantile(double p)
{
    static const double a[] = {3.3871327179, 50.434271938, 159.29113202, 59.109374720};
    static const double b[] = {1.0, 17.895169469, 78.757757664, 67.187563600};
    static const double c[] = {1.4234372777, 2.7568153900, 1.3067284816, 0.17023821103};
    static const double d[] = {1.0, 0.73700164250, 0.12021132975};
    static const double e[] = {6.6579051150, 3.0812263860, 0.42868294337, 0.017337203997};
    static const double f[] = {1.0, 0.24197894225, 0.012258202635};
    const double q = p - 0.5;
    if (fabs(q) <= 0.425) {
        double r = 0.180625 - q * q;
        return q * polynomial(a, 4, r) / polynomial(b, 4, r);
    }
    const double r = sqrt(-log(fmin(p, 1.0 - p)));
    const double z = r <= 5.0 ? polynomial(c, 4, r - 1.6) / polynomial(d, 3, r - 1.6)
                              : polynomial(e, 4, r - 5.0) / polynomial(f, 3, r - 5.0);
    return q < 0.0 ? -z : z;
}

static double transformed(enum sim_scale scale, double value)
{
    switch (scale) {
    case SIM_SCALE_LOG:
        return log10(value);
    case SIM_SCALE_NORMAL:
        return sim_normal_quantile(value);
    case SIM_SCALE_LINEAR:
        break;
    }
    return value;
}

double sim_axis_place(const struct sim_axis *axis, double value)
{
    const double clamped = fmin(fmax(value, axis->from), axis->to);
    const double from = transformed(axis->scale, axis->from),
                 to = transformed(axis->scale, axis->to);
    return (transformed(axis->scale, clamped) - from) / (to - from);
}

static size_t linear_ticks(const struct sim_axis *axis, struct sim_tick *ticks)
{
    /* The step is 1, 2 or 5 times a power of ten, chosen for about six ticks. */
    const double rough = (axis->to - axis->from) / 6.0, decade = pow(10.0, floor(log10(rough)));
    const double ratio = rough / decade; /* 1..10 */
    double factor = 10.0;
    if (ratio < 1.5) {
        factor = 1.0;
    } else if (ratio < 3.5) {
        factor = 2.0;
    } else if (ratio < 7.5) {
        factor = 5.0;
    }
    const double step = decade * factor;
    size_t n = 0;
    const double first = ceil(axis->from / step - 1e-9);
    for (double k = first; k * step <= axis->to + 1e-9 * step && n < SIM_TICKS_MAX; k += 1.0) {
        ticks[n].value = k * step + 0.0; /* never -0 */
        (void)snprintf(ticks[n].label, sizeof ticks[n].label, "%.6g", ticks[n].value);
        n++;
    }
    return n;
}

static size_t log_ticks(const struct sim_axis *axis, struct sim_tick *ticks)
{
    size_t n = 0;
    const double first = ceil(log10(axis->from) - 1e-9);
    for (double k = first; k <= log10(axis->to) + 1e-9 && n < SIM_TICKS_MAX; k += 1.0) {
        ticks[n].value = pow(10.0, k);
        (void)snprintf(ticks[n].label, sizeof ticks[n].label, "%.6g", ticks[n].value);
        n++;
    }
    return n;
}

static size_t normal_ticks(const struct sim_axis *axis, struct sim_tick *ticks)
{
    static const double percent[] = {0.001, 0.01, 0.1, 0.5, 1,  2,  5,    10,
                                     20,    40,   60,  80,  90, 95, 99.0, 99.9};
    size_t n = 0;
    for (size_t i = 0; i < sizeof percent / sizeof *percent; i++) {
        const double value = percent[i] / 100.0;
        if (value >= axis->from * (1.0 - 1e-9) && value <= axis->to * (1.0 + 1e-9)) {
            ticks[n].value = value;
            (void)snprintf(ticks[n].label, sizeof ticks[n].label, "%g %%", percent[i]);
            n++;
        }
    }
    return n;
}

size_t sim_axis_ticks(const struct sim_axis *axis, struct sim_tick ticks[SIM_TICKS_MAX])
{
    switch (axis->scale) {
    case SIM_SCALE_LOG:
        return log_ticks(axis, ticks);
    case SIM_SCALE_NORMAL:
        return normal_ticks(axis, ticks);
    case SIM_SCALE_LINEAR:
        break;
    }
    return linear_ticks(axis, ticks);
}
