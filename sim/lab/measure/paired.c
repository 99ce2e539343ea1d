#include "sim/lab/measure/paired.h"

#include <errno.h>
#include <stdlib.h>

#include "sim/base/random.h"

enum { ALL_SIGNS_MAX = 16, DRAWS = 99999 };

/* The absolute value of the sum of the differences; bit i set: difference i has the other sign. */
static long signed_sum(const long *difference, size_t n, uint64_t bits)
{
    long sum = 0;
    for (size_t i = 0; i < n; i++) {
        sum += (bits >> i) & 1 ? -difference[i] : difference[i];
    }
    return labs(sum);
}

static double try_all_signs(const long *difference, size_t n, long observed)
{
    uint64_t n_signs = UINT64_C(1) << n, as_far = 0;
    for (uint64_t bits = 0; bits < n_signs; bits++) {
        as_far += signed_sum(difference, n, bits) >= observed;
    }
    return (double)as_far / (double)n_signs;
}

static double draw_signs(const long *difference, size_t n, long observed)
{
    struct sim_random random = sim_random_seeded(1, sim_random_hash("paired"), 0);
    uint64_t as_far = 1; /* the observed one */
    for (int k = 0; k < DRAWS; k++) {
        long sum = 0;
        uint64_t bits = 0;
        for (size_t i = 0; i < n; i++) {
            bits = i % 64 == 0 ? sim_random_u64(&random) : bits >> 1;
            sum += bits & 1 ? -difference[i] : difference[i];
        }
        as_far += labs(sum) >= observed;
    }
    return (double)as_far / (DRAWS + 1.0);
}

int sim_paired_test(const uint8_t *first, const uint8_t *second, const uint32_t *person, size_t n,
                    uint32_t n_people, struct sim_paired *out)
{
    struct sim_paired paired = {.p = 1.0};
    long *difference = calloc(n_people + 1, sizeof *difference);
    uint8_t *searched = calloc(n_people + 1, 1);
    if (!difference || !searched) {
        free(difference);
        free(searched);
        return -ENOMEM;
    }
    for (size_t i = 0; i < n; i++) {
        paired.first_errors += first[i];
        paired.second_errors += second[i];
        difference[person[i]] += second[i] - first[i];
        searched[person[i]] = 1;
    }
    /* Only people for whom the methods differ have a sign to change. */
    size_t n_differ = 0;
    long sum = 0;
    for (uint32_t p = 0; p < n_people; p++) {
        paired.people += searched[p];
        paired.first_better += difference[p] > 0;
        paired.second_better += difference[p] < 0;
        sum += difference[p];
        if (difference[p] != 0) {
            difference[n_differ++] = difference[p];
        }
    }
    if (n_differ > 0) {
        paired.p = n_differ <= ALL_SIGNS_MAX ? try_all_signs(difference, n_differ, labs(sum))
                                             : draw_signs(difference, n_differ, labs(sum));
    }
    free(difference);
    free(searched);
    *out = paired;
    return 0;
}
