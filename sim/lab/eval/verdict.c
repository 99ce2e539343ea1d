#include "sim/lab/eval/verdict.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>

/* The index of the lowest FMR that the comparisons support and that is not below the table's; 0 if
 * there is none. */
static int supported_fmr(const struct sim_verification *v)
{
    int k = SIM_VERDICT_FMR;
    while (k > 0 && !v->at_fmr[k].supported) {
        k--;
    }
    return k;
}

/* Marks the errors of a method for each search: rank above 1, or no match at the threshold. */
static void mark_errors(const struct sim_analysis *a, int fmr, uint8_t *rank, uint8_t *match)
{
    const struct sim_identification *id = &a->identification;
    const double threshold = a->verification.at_fmr[fmr].at.threshold;
    for (size_t i = 0; i < id->n_searches; i++) {
        rank[i] = id->searches[i].rank != 1;
        match[i] = id->searches[i].rank == 0 || id->searches[i].mate_score < threshold;
    }
}

/* The person of each mated search, in the order of the searches. */
static void list_people(const struct sim_analysis *a, size_t n_probes, uint32_t *person)
{
    size_t n = 0;
    for (size_t i = 0; i < n_probes; i++) {
        if (a->kind[i] == SIM_PROBE_MATED) {
            person[n++] = a->person[i];
        }
    }
}

static int compare(const struct sim_eval *eval, const struct sim_analysis *a, int fmr,
                   struct sim_verdict *verdict)
{
    const size_t n = a->identification.n_searches;
    uint8_t *errors = calloc(4 * n + 1, 1);
    uint32_t *person = calloc(n + 1, sizeof *person);
    int error = errors && person ? 0 : -ENOMEM;
    if (!error) {
        list_people(a, eval->matches->n_probes, person);
        mark_errors(eval->analysis, fmr, errors, errors + n);
        mark_errors(a, fmr, errors + 2 * n, errors + 3 * n);
        error = sim_paired_test(errors, errors + 2 * n, person, n, a->n_subjects,
                                &verdict->at_rank_1);
    }
    if (!error) {
        error = sim_paired_test(errors + n, errors + 3 * n, person, n, a->n_subjects,
                                &verdict->at_fmr);
    }
    free(errors);
    free(person);
    return error;
}

int sim_verdict_of(const struct sim_eval *eval, size_t index, struct sim_verdict *out)
{
    const struct sim_analysis *a = eval->methods[index].analysis;
    const struct sim_identification *id = &a->identification;
    const struct sim_verification *v = &a->verification;
    const int fmr = supported_fmr(&eval->analysis->verification);
    struct sim_verdict verdict = {
        .method = eval->methods[index].method,
        .wall_ns = eval->methods[index].wall_ns,
        .rank_1 = sim_rank_rate(id->searches, id->n_searches, 1),
        .rank_4 = sim_rank_rate(id->searches, id->n_searches, 4),
        .lost = {v->n_lost, id->n_searches},
        .eer = v->n_det > 0 ? v->eer : NAN,
        .eer_interval = v->eer_interval,
        .fmr = sim_fmr_targets[fmr],
        .at = v->at_fmr[fmr],
        .at_coarse = v->at_fmr[SIM_VERDICT_COARSE_FMR],
    };
    const int error = compare(eval, a, fmr, &verdict);
    if (!error) {
        *out = verdict;
    }
    return error;
}
