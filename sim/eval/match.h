/* Compares every probe sample with every enrolled person.
 *
 * A probe is a template and nothing else here, so that no comparison can depend on whose it is. A
 * person with several templates counts by the best of them. */
#ifndef SIM_EVAL_MATCH_H
#define SIM_EVAL_MATCH_H

#include <stdint.h>

#include "core/match/cohort.h"
#include "sim/eval/acquire.h"
#include "sim/eval/gallery.h"

/* The results of the searches of all samples that are not in a gallery row. */
struct sim_matches {
    size_t n_probes, n_people;
    size_t *sample;      /* [n_probes], rising */
    double *distance_mm; /* [n_probes][n_people]; INFINITY: not comparable */
    double *score;       /* the same shape; -INFINITY: not comparable */
    int64_t *wall_ns,
        *cpu_ns; /* [n_probes]: of the whole search; 0 if the sample was not acquired */
};

/* Without a cohort (NULL) the score is the negative distance. A probe that cannot be compared with
 * the cohort becomes a failure to acquire ("too-few-points"). -ENOMEM, or the errors of
 * iso_match_distance. */
int sim_match(const struct sim_corpus *corpus, struct sim_acquisition *acquisition,
              const struct sim_gallery *gallery, const struct iso_cohort *cohort,
              const struct iso_match_options *options, int threads, struct sim_matches **out)
    __attribute__((warn_unused_result));
void sim_matches_free(struct sim_matches *matches);

#endif
