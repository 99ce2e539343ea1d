/* Chebyshev expansion of the exponential. */
#ifndef ISO_CORE_HEAT_GRID_CHEBYSHEV_H
#define ISO_CORE_HEAT_GRID_CHEBYSHEV_H

enum { ISO_CHEBYSHEV_TERMS_MAX = 640 };

/* Computes c[k] such that exp(-z (1 + x)) = sum_k c[k] T_k(x) for x in -1..1. c[0] is exp(-z)
 * I_0(z) and the others are 2 (-1)^k exp(-z) I_k(z), with the modified Bessel functions I_k
 * (Tal-Ezer 1989; Abramowitz and Stegun 1964, 9.6.34), by Miller's downward recurrence (9.12).
 * Returns the number of terms that are needed: at every x the remaining ones add up to less than
 * `tolerance`. -ERANGE if z is not above 0, or too large for ISO_CHEBYSHEV_TERMS_MAX (beyond about
 * 4400). */
int iso_chebyshev_exp(double z, double tolerance, double c[ISO_CHEBYSHEV_TERMS_MAX])
    __attribute__((warn_unused_result));

#endif
