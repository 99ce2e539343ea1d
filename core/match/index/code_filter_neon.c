/* The filter for aarch64 processors, all of which have NEON; empty on other architectures. */
#if defined __aarch64__
#include <arm_neon.h>

#include "core/match/index/code_filter.h"

enum { FOUR = 4 }; /* people of a register */

/* The sums of four people. */
static int32x4_t sums_of_four(const int8_t *codes, const struct iso_code_probe *probe, int n_pairs)
{
    int32x4_t sum = vdupq_n_s32(0);
    for (int p = 0; p < n_pairs; p++, codes += 2 * ISO_CODE_LANES) {
        const int16x4x2_t weight = vld2_dup_s16(&probe->weight[2 * p]);
        const int16x4x2_t centre = vld2_dup_s16(&probe->centre[2 * p]);
        const int8x8_t both = vld1_s8(codes);
        const int16x4_t even = vget_low_s16(vmovl_s8(vuzp1_s8(both, both)));
        const int16x4_t odd = vget_low_s16(vmovl_s8(vuzp2_s8(both, both)));
        const int16x4_t first = vsub_s16(vmul_s16(even, weight.val[0]), centre.val[0]);
        const int16x4_t second = vsub_s16(vmul_s16(odd, weight.val[1]), centre.val[1]);
        sum = vmlal_s16(vmlal_s16(sum, first, first), second, second);
    }
    return sum;
}

uint32_t iso__code_filter_neon(const int8_t *codes, const struct iso_code_probe *probe, int n_pairs,
                               int32_t limit)
{
    const uint32x4_t bit = {1, 2, 4, 8};
    uint32_t passed = 0;
    for (int i = 0; i < ISO_CODE_LANES; i += FOUR) {
        const int32x4_t sum = sums_of_four(codes + 2 * i, probe, n_pairs);
        const uint32x4_t within = vcleq_s32(sum, vdupq_n_s32(limit));
        passed |= vaddvq_u32(vandq_u32(within, bit)) << i;
    }
    return passed;
}
#endif
