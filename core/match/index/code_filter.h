/* The inner loop of the coarse search: which of the people of a block may be among the best, by
 * their codes of eight bits a number. Internal to core/match/index.
 *
 * A block has ISO_CODE_LANES people. codes is [n_pairs][ISO_CODE_LANES][2]: two numbers of each
 * person. The difference of a code from the probe is weight * code - centre, with a weight and a
 * centre for each number. Bit i of the result says whether the squares of the differences of person
 * i add up to at most `limit`. The caller chooses weights with which every difference
 * fits in 16 bits and every sum in 32 bits. All filters compute with whole numbers, so their
 * results are equal. */
#ifndef ISO_CORE_MATCH_INDEX_CODE_FILTER_H
#define ISO_CORE_MATCH_INDEX_CODE_FILTER_H

#include <stdint.h>

enum {
    ISO_CODE_LANES = 32,
    ISO_CODE_PAIRS_MAX = 30, /* numbers of a person that have codes: twice as many at most */
    ISO_CODE_NUMBERS_MAX = 2 * ISO_CODE_PAIRS_MAX,
};

/* A probe as the filter compares it. */
struct iso_code_probe {
    int16_t weight[ISO_CODE_NUMBERS_MAX], centre[ISO_CODE_NUMBERS_MAX];
};

typedef uint32_t iso_code_filter(const int8_t *codes, const struct iso_code_probe *probe,
                                 int n_pairs, int32_t limit);

iso_code_filter iso__code_filter_plain;
iso_code_filter iso__code_filter_avx2; /* x86-64 only */
iso_code_filter iso__code_filter_neon; /* aarch64 only */

/* The one for this machine; NULL if it has none that is faster than to score everybody. */
iso_code_filter *iso_code_filter_here(void);

#endif
