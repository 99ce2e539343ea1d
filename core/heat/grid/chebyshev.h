/* Chebyshev expansion of the exponential. */
#ifndef ISO_CORE_HEAT_GRID_CHEBYSHEV_H
#define ISO_CORE_HEAT_GRID_CHEBYSHEV_H

enum { ISO_CHEBYSHEV_TERMS_MAX = 640 };

/* c[k] with exp(-z (1 + x)) = sum_k c[k] T_k(x) for x in -1..1: (2 -) (-1)^k exp(-z) I_k(z), I_k
 * the modified Bessel functions (Tal-Ezer 1989; Abramowitz and Stegun 1964, 9.6.34), by Miller's
 * downward recurrence (9.12). Returns how many terms matter: those left out add up to less than
 * `tolerance`, anywhere. -ERANGE if they do not fit (z beyond 2000 at a tolerance of 1e-9). */
int iso_chebyshev_exp(double z, double tolerance, double c[ISO_CHEBYSHEV_TERMS_MAX])
    __attribute__((warn_unused_result));

#endif
