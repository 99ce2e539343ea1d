/* For every processor of the architecture (SSE2 on x86-64, NEON on aarch64), and the choice. */
#include <stdbool.h>

enum { WIDE = 4 };
#define GRAM iso__gram_baseline
#include "core/base/gram/gram.inc"

#if defined __x86_64__
bool iso__gram_has_avx512(void)
{
    return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vbmi2");
}
#endif

void iso_gram(const float *rows, int n_rows, int n, double *h)
{
#if defined __x86_64__
    if (iso__gram_has_avx512()) {
        iso__gram_avx512(rows, n_rows, n, h);
        return;
    }
    if (__builtin_cpu_supports("avx2")) {
        iso__gram_avx2(rows, n_rows, n, h);
        return;
    }
#endif
    iso__gram_baseline(rows, n_rows, n, h);
}
