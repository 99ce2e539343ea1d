/* The filter for x86-64 processors with AVX2; empty on other architectures. */
#if defined __x86_64__
#include <immintrin.h>
#include <string.h>

#include "core/match/index/code_filter.h"

enum {
    EIGHT = 8,    /* people of a register */
    AHEAD = 4096, /* bytes */
};

/* Codes are fetched about two blocks ahead. By itself a processor fetches ahead within a page only,
 * and waits at the beginning of each of the 16 thousand pages of a million people. The fetch may
 * lie beyond the last block, where it does nothing. */
__attribute__((target("avx2"))) uint32_t iso__code_filter_avx2(const int8_t *codes,
                                                               const struct iso_code_probe *probe,
                                                               int n_pairs, int32_t limit)
{
    const __m256i most = _mm256_set1_epi32(limit);
    __m256i sum[ISO_CODE_LANES / EIGHT];
    sum[0] = sum[1] = sum[2] = sum[3] = _mm256_setzero_si256();
    for (int p = 0; p < n_pairs; p++, codes += 2 * ISO_CODE_LANES) {
        int32_t weights, centres;
        memcpy(&weights, &probe->weight[2 * p], sizeof weights);
        memcpy(&centres, &probe->centre[2 * p], sizeof centres);
        const __m256i weight = _mm256_set1_epi32(weights), centre = _mm256_set1_epi32(centres);
        _mm_prefetch((const void *)((uintptr_t)codes + AHEAD), _MM_HINT_T0);
#pragma GCC unroll 4
        for (int k = 0; k < ISO_CODE_LANES / EIGHT; k++) {
            const __m128i_u *at = (const __m128i_u *)&codes[2 * EIGHT * k];
            const __m256i code = _mm256_cvtepi8_epi16(_mm_loadu_si128(at));
            const __m256i difference = _mm256_sub_epi16(_mm256_mullo_epi16(code, weight), centre);
            sum[k] = _mm256_add_epi32(sum[k], _mm256_madd_epi16(difference, difference));
        }
    }
    uint32_t beyond = 0;
    for (int k = 0; k < ISO_CODE_LANES / EIGHT; k++) {
        const __m256i more = _mm256_cmpgt_epi32(sum[k], most);
        beyond |= (uint32_t)_mm256_movemask_ps(_mm256_castsi256_ps(more)) << (EIGHT * k);
    }
    return ~beyond;
}
#endif
