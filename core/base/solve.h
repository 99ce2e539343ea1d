/* Small dense symmetric positive definite systems, up to a few dozen unknowns. */
#ifndef ISO_CORE_BASE_SOLVE_H
#define ISO_CORE_BASE_SOLVE_H

/* Computes the Cholesky factor in place: the lower triangle of the row-major n x n matrix a becomes
 * L with A = L L'. What the upper triangle holds does not
 * change L; it may be overwritten. -EDOM if a pivot falls below 1e-12 of its diagonal entry
 * (singular, indefinite or not finite). */
int iso_cholesky_factorise(double *a, int n) __attribute__((warn_unused_result));

/* The same, to the bit, for every processor of the architecture. iso_cholesky_factorise() calls the
 * fastest one that this machine can run. */
int iso__cholesky_factorise_baseline(double *a, int n) __attribute__((warn_unused_result));

/* Solves L L' x = b for a factor from iso_cholesky_factorise. b [n] becomes x. */
void iso_cholesky_solve(const double *l, int n, double *b);

#endif
