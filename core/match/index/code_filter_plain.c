/* The filter in plain C, and the function that chooses a filter for this machine. Tests compare the
 * other filters with this one. */
#include <stddef.h>

#include "core/match/index/code_filter.h"

uint32_t iso__code_filter_plain(const int8_t *codes, const struct iso_code_probe *probe,
                                int n_pairs, int32_t limit)
{
    uint32_t passed = 0;
    for (int i = 0; i < ISO_CODE_LANES; i++) {
        int32_t sum = 0;
        for (int d = 0; d < 2 * n_pairs; d++) {
            const int code = codes[(d / 2 * ISO_CODE_LANES + i) * 2 + d % 2];
            const int32_t difference = probe->weight[d] * code - probe->centre[d];
            sum += difference * difference;
        }
        passed |= (uint32_t)(sum <= limit) << i;
    }
    return passed;
}

iso_code_filter *iso_code_filter_here(void)
{
#if defined __x86_64__
    return __builtin_cpu_supports("avx2") ? iso__code_filter_avx2 : NULL;
#elif defined __aarch64__
    return iso__code_filter_neon;
#else
    return NULL;
#endif
}
