/* Identification: error rates of searches of a whole gallery (ISO/IEC 19795-1:2021).
 *
 * Closed set: rank and CMC. Open set: a search that may be of somebody who is not enrolled; FPIR is
 * the share of the searches of strangers that return anybody at the threshold, FNIR the share of
 * the searches of enrolled people that do not return that person as the first candidate at the
 * threshold (one candidate, since a door acts on the first only). */
#ifndef SIM_LAB_MEASURE_IDENTIFICATION_H
#define SIM_LAB_MEASURE_IDENTIFICATION_H

#include <stddef.h>

#include "sim/lab/measure/rate.h"

/* The rank of the mate among n scores, from 1: those with the same score stand before it. */
size_t sim_rank(const double *scores, size_t n, size_t mate);

/* A search of an enrolled person. */
struct sim_mated_search {
    size_t rank;       /* 0: missed (not acquired, or the person could not be enrolled) */
    double mate_score; /* only if rank is not 0 */
};

/* Share of the searches whose mate is among the first `rank`; a missed one never is. */
struct sim_rate sim_rank_rate(const struct sim_mated_search *searches, size_t n, size_t rank);

struct sim_open_set_point {
    double threshold; /* accepted if at least this */
    struct sim_rate fpir, fnir;
};

/* The lowest threshold at which FPIR is not above `fpir`. top_score: the best score of each search
 * of a stranger, -INFINITY if not acquired; sorted in place. n_top >= 1. */
struct sim_open_set_point sim_open_set_at_fpir(const struct sim_mated_search *searches, size_t n,
                                               double *top_score, size_t n_top, double fpir);

#endif
