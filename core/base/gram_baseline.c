/* For every processor of the architecture: SSE2 on x86-64, NEON on aarch64. */
enum { WIDE = 4 };
#define GRAM iso__gram_baseline
#include "core/base/gram.inc"

void iso_gram(const float *rows, int n_rows, int n, double *h)
{
#if defined __x86_64__
    if (__builtin_cpu_supports("avx2")) {
        iso__gram_avx2(rows, n_rows, n, h);
        return;
    }
#endif
    iso__gram_baseline(rows, n_rows, n, h);
}
