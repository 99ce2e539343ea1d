#include "core/base/proportion.h"

#include <math.h>

/* Computes the continued fraction of the incomplete beta function (DLMF 8.17.22) with the modified
 * Lentz algorithm (Thompson and Barnett 1986). It converges fast if x < (a + 1) / (a + b + 2). */
static double beta_fraction(double a, double b, double x)
{
    const double tiny = 1e-300;
    double c = 1.0, d = 1.0 / fmax(1.0 - (a + b) * x / (a + 1.0), tiny), f = d;
    for (int m = 1; m < 10000; m++) {
        const double even = m * (b - m) * x / ((a + 2.0 * m - 1.0) * (a + 2.0 * m));
        const double odd = -(a + m) * (a + b + m) * x / ((a + 2.0 * m) * (a + 2.0 * m + 1.0));
        d = 1.0 / fmax(1.0 + even * d, tiny);
        c = fmax(1.0 + even / c, tiny);
        f *= c * d;
        d = 1.0 / fmax(1.0 + odd * d, tiny);
        c = fmax(1.0 + odd / c, tiny);
        f *= c * d;
        if (fabs(c * d - 1.0) < 1e-14) {
            break;
        }
    }
    return f;
}

static double log_gamma(double x)
{
    int sign; /* lgamma() itself writes a global */
    return lgamma_r(x, &sign);
}

/* Returns the probability that a number is at most x, 0 < x < 1, if the number has the beta
 * distribution with the parameters a and b. */
static double beta_share(double a, double b, double x)
{
    const double front = exp(log_gamma(a + b) - log_gamma(a) - log_gamma(b) + a * log(x) +
                             b * log1p(-x));
    return x < (a + 1.0) / (a + b + 2.0) ? front * beta_fraction(a, b, x) / a
                                         : 1.0 - front * beta_fraction(b, a, 1.0 - x) / b;
}

/* Returns the x at which beta_share() has this value. */
static double beta_quantile(double a, double b, double share)
{
    double low = 0.0, high = 1.0;
    for (int i = 0; i < 60; i++) {
        const double middle = 0.5 * (low + high);
        if (beta_share(a, b, middle) < share) {
            low = middle;
        } else {
            high = middle;
        }
    }
    return 0.5 * (low + high);
}

struct iso_interval iso_proportion_interval(double rate, double trials)
{
    if (!(trials > 0.0)) {
        return (struct iso_interval){0.0, 1.0};
    }
    const double events = rate * trials, others = (1.0 - rate) * trials;
    return (struct iso_interval){
        rate <= 0.0 ? 0.0 : beta_quantile(events, others + 1.0, 0.025),
        rate >= 1.0 ? 1.0 : beta_quantile(events + 1.0, others, 0.975),
    };
}
