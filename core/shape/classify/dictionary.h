/* Coding over a dictionary of all shapes at once.
 *
 * alpha = (D D' + c I)^-1 b, where D has one feature in each row, and b = D y plus whatever else
 * determines alpha. The eigenvectors of D D' are computed once. With them each c > 0 costs two
 * products of a matrix with a vector, and an atom can be left out exactly, by the constraint that
 * its coefficient is 0. */
#ifndef ISO_CORE_SHAPE_CLASSIFY_DICTIONARY_H
#define ISO_CORE_SHAPE_CLASSIFY_DICTIONARY_H

#include <stdint.h>

struct iso_dictionary {
    int32_t n, size;
    const float *atom; /* [n] rows of `stride` values, borrowed; the first `size` are used */
    int32_t stride;
    double *square; /* [n]: of the length of each atom */
    double *value;  /* [n]: eigenvalues of D D' */
    double *vector; /* [n][n]: eigenvectors, one after another */
};

/* Makes a dictionary of n features of `size` values, which it borrows. -ENOMEM, -EDOM if the atoms
 * are not finite. */
int iso_dictionary_init(struct iso_dictionary *d, const float *atom, int32_t n, int32_t size,
                        int32_t stride) __attribute__((warn_unused_result));

/* Releases what it holds. */
void iso_dictionary_done(struct iso_dictionary *d);

/* Computes product [n] = D y. */
void iso_dictionary_products(const struct iso_dictionary *d, const float *y, double *product);

/* Computes alpha [n] for the right side b [n]. `left` is the atom that is left out, or -1. scratch
 * [2 n] is working memory. */
void iso_dictionary_solve(const struct iso_dictionary *d, double c, const double *b, int32_t left,
                          double *scratch, double *alpha);

#endif
