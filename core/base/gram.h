/* Sums of outer products of many short rows: the left side of least squares. */
#ifndef ISO_CORE_BASE_GRAM_H
#define ISO_CORE_BASE_GRAM_H

/* Rows are padded with zeros to a multiple of so many values, and begin at such addresses. */
enum { ISO_GRAM_LANES = 4, ISO_GRAM_ALIGNMENT = 16 };

typedef float iso_lanes __attribute__((vector_size(16)));

static inline iso_lanes iso_lanes_at(const float *aligned)
{
    return *(const iso_lanes *)aligned;
}

static inline double iso_lanes_sum(iso_lanes v)
{
    return (double)(v[0] + v[1] + v[2] + v[3]);
}

static inline int iso_gram_stride(int n)
{
    return (n + ISO_GRAM_LANES - 1) / ISO_GRAM_LANES * ISO_GRAM_LANES;
}

/* h (n x n, row-major) becomes A'A in its lower triangle, for rows[n_rows][iso_gram_stride(n)]
 * aligned to 16 bytes. In single precision, blocks of 4 x 4 entries at a time: the relative error
 * of an entry is about 1e-7 times the square root of the number of rows. */
void iso_gram(const float *rows, int n_rows, int n, double *h);

#endif
