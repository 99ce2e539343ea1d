/* Sums of outer products of many short rows: the left side of least squares. */
#ifndef ISO_CORE_BASE_GRAM_H
#define ISO_CORE_BASE_GRAM_H

#include <stdbool.h>

/* The length of each row is a multiple of ISO_GRAM_LANES values; the caller fills the end of a
 * shorter row with zeros. The address of each row is a multiple of ISO_GRAM_ALIGNMENT bytes. Rows
 * are read fastest if the first one begins a line of the cache, at a multiple of ISO_GRAM_LINE
 * bytes. */
enum { ISO_GRAM_LANES = 4, ISO_GRAM_ALIGNMENT = 16, ISO_GRAM_LINE = 64 };

/* Four floats at once. core/base/lanes.h has the wider vectors of code that is compiled for each
 * processor. */
typedef float iso_gram_lanes __attribute__((vector_size(16)));

/* Returns the four values at this address, which is a multiple of ISO_GRAM_ALIGNMENT. */
static inline iso_gram_lanes iso_gram_lanes_at(const float *aligned)
{
    return *(const iso_gram_lanes *)aligned;
}

/* Writes four values to an address that need not be such a multiple. */
typedef float iso_gram_lanes_in_memory
    __attribute__((vector_size(ISO_GRAM_LANES * sizeof(float)), aligned(4), may_alias));
#define ISO_GRAM_LANES_STORE(p, value) (*(iso_gram_lanes_in_memory *)(p) = (value))

/* Values of a padded row of n values. */
static inline int iso_gram_stride(int n)
{
    return (n + ISO_GRAM_LANES - 1) / ISO_GRAM_LANES * ISO_GRAM_LANES;
}

/* Writes A'A to the lower triangle of h (n x n, row-major) and zeros to the rest of h. The rows of
 * A are rows[n_rows][iso_gram_stride(n)], aligned to 16 bytes. Products are summed in single
 * precision over 128 rows at a time, so that the relative error of an entry is about 1e-6. */
void iso_gram(const float *rows, int n_rows, int n, double *h);

/* The same function for each kind of processor. The results are the same to the bit: each entry is
 * the same sum in the same order. (On arm64 the compiler may join a product and a sum into one
 * instruction.) iso_gram() calls the fastest one that this machine can run. */
typedef void iso_gram_function(const float *rows, int n_rows, int n, double *h);

iso_gram_function iso__gram_baseline;
iso_gram_function iso__gram_avx2;   /* x86-64 only */
iso_gram_function iso__gram_avx512; /* x86-64 only */

/* Whether iso__gram_avx512 gains on this machine. The first processors with AVX-512 lower their
 * clock for it; those with its second set of byte instructions (Intel's of 2019 on, AMD's of 2022
 * on) hardly do. x86-64 only. */
bool iso__gram_has_avx512(void);

#endif
