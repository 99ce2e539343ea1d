#include "core/base/gram.h"

#include <stddef.h>

/* The rows of one chunk are summed in single precision; the sums of the chunks are added in double
 * precision. */
enum { CHUNK = 128 };

/* Adds the 4 x 4 block of entries that begins at (a, b), for some rows. */
static void add_block(const float *rows, int n_rows, int stride, int a, int b, int n, double *h)
{
    iso_gram_lanes sum[ISO_GRAM_LANES] = {{0}};
    const float *row = rows;
    for (int i = 0; i < n_rows; i++, row += stride) {
        iso_gram_lanes right = iso_gram_lanes_at(row + b);
        sum[0] += row[a] * right;
        sum[1] += row[a + 1] * right;
        sum[2] += row[a + 2] * right;
        sum[3] += row[a + 3] * right;
    }
    for (int i = 0; i < ISO_GRAM_LANES && a + i < n; i++) {
        for (int j = 0; j < ISO_GRAM_LANES && b + j <= a + i; j++) {
            h[(size_t)(a + i) * (size_t)n + (size_t)(b + j)] += (double)sum[i][j];
        }
    }
}

void iso_gram(const float *rows, int n_rows, int n, double *h)
{
    const int stride = iso_gram_stride(n);
    for (int i = 0; i < n * n; i++) {
        h[i] = 0.0;
    }
    for (int first = 0; first < n_rows; first += CHUNK) {
        const int some = n_rows - first < CHUNK ? n_rows - first : CHUNK;
        for (int a = 0; a < n; a += ISO_GRAM_LANES) {
            for (int b = 0; b <= a; b += ISO_GRAM_LANES) {
                add_block(rows + (size_t)first * (size_t)stride, some, stride, a, b, n, h);
            }
        }
    }
}
