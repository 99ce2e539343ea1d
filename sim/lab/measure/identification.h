/* Identification: error rates of searches of a whole gallery (ISO/IEC 19795-1:2021).
 *
 * Closed set: rank and CMC. Open set: a search may be for a person who is not enrolled. FPIR is
 * the share of strangers' searches that return any candidate at the threshold. FNIR is the share
 * of enrolled people's searches that do not return this person as the first candidate at the
 * threshold. Only the first candidate counts, because a door acts on no other. */
#ifndef SIM_LAB_MEASURE_IDENTIFICATION_H
#define SIM_LAB_MEASURE_IDENTIFICATION_H

#include <stddef.h>

#include "sim/lab/measure/rate.h"

/* The rank of the mate among n scores, from 1. Equal scores rank before the mate. */
size_t sim_rank(const double *scores, size_t n, size_t mate);

/* A search of an enrolled person. */
struct sim_mated_search {
    size_t rank;       /* 0: missed (probe not acquired, or the person not enrolled) */
    double mate_score; /* only if rank is not 0 */
};

/* Share of the searches whose mate is among the first `rank` candidates; missed searches never
 * count. */
struct sim_rate sim_rank_rate(const struct sim_mated_search *searches, size_t n, size_t rank);

struct sim_open_set_point {
    double threshold; /* scores from this value on are accepted */
    struct sim_rate fpir, fnir;
};

/* The lowest threshold at which FPIR is at most `fpir`. top_score is the best score of each
 * stranger's search, -INFINITY if not acquired; it is sorted in place. n_top >= 1. */
struct sim_open_set_point sim_open_set_at_fpir(const struct sim_mated_search *searches, size_t n,
                                               double *top_score, size_t n_top, double fpir);

#endif
