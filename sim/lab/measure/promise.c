#include "sim/lab/measure/promise.h"

/* The number of n rising scores below a given score. */
static size_t count_below(const struct sim_score *scores, size_t n, double score)
{
    size_t low = 0, high = n;
    while (low < high) {
        const size_t middle = (low + high) / 2;
        if (scores[middle].score < score) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    return low;
}

void sim_promises_of(const struct sim_scores *scores, struct sim_promise out[SIM_PROMISES])
{
    for (int i = 0; i < SIM_PROMISES; i++) {
        const double score = 1.0 + i;
        const size_t n = scores->n_non_mated;
        out[i] = (struct sim_promise){
            .score = score,
            .false_match = {n - count_below(scores->non_mated, n, score), n},
            .non_match = {count_below(scores->mated, scores->n_mated, score), scores->n_mated},
        };
    }
}
