/* Compares every probe sample with every enrolled person.
 *
 * A probe is only a template here, so that no comparison can depend on the subject. A person
 * with several templates counts by the best of them; with a metric, by all of them together. */
#ifndef SIM_LAB_MATCH_MATCH_H
#define SIM_LAB_MATCH_MATCH_H

#include <stdint.h>

#include "core/match/cohort.h"
#include "core/match/rerank.h"
#include "core/match/site.h"
#include "sim/lab/match/acquire.h"
#include "sim/lab/match/gallery.h"

/* The source of a score: the metric, or else the distance of registered curves, normalised by
 * the cohort if there is one. */
struct sim_scoring {
    const struct iso_metric *metric; /* NULL: distances */
    const struct iso_cohort *cohort; /* NULL: the score is the negative distance */
    struct iso_match_options match;  /* of distances */
    bool rerank; /* with a metric: rerank the best candidates (core/match/rerank.h). The others keep
                    the metric's score, limited to the lowest score of the reranked ones */
    const struct iso_site_metric *site; /* the metric is adapted to the people of the gallery
                                           themselves (core/match/site.h); NULL: it is not */
    const struct iso_metric *shipped;   /* with `site`: chooses the candidates for reranking, as the
                                           index of a daemon does (firmware/site/site_index.h) */
    const bool *wanted; /* [n_samples of the acquisition]: only these are searched; NULL: all */
};

/* The results of the searches of all samples that are not in a gallery row. */
struct sim_matches {
    size_t n_probes, n_people;
    size_t *sample;      /* [n_probes], rising */
    double *distance_mm; /* [n_probes][n_people]; INFINITY: not comparable; NaN with a metric */
    double *score;       /* the same shape; -INFINITY: not comparable */
    /* The same shape, or NULL: the scores of a metric that is adapted to a site without the
     * visitor. They are used for comparisons of an enrolled visitor with another person
     * (sim/lab/eval/site_gallery.h). */
    double *stranger_score;
    int64_t *wall_ns,
        *cpu_ns; /* [n_probes]: of the whole search; no meaning if the sample was not acquired */
};

/* Allocates the searches of all samples that are not in a gallery row: distances INFINITY,
 * scores -INFINITY, times 0. -ENOMEM. */
int sim_matches_new(const struct sim_corpus *corpus, const struct sim_acquisition *acquisition,
                    size_t n_people, struct sim_matches **out) __attribute__((warn_unused_result));

/* Compares every probe with the gallery. A probe that cannot be compared with the cohort or
 * projected by the metric becomes a failure to acquire ("too-few-points"). -ENOMEM, or the errors
 * of iso_match_distance, iso_cohort_normalise, iso_metric_project or sim_parallel. */
int sim_match(const struct sim_corpus *corpus, struct sim_acquisition *acquisition,
              const struct sim_gallery *gallery, const struct sim_scoring *scoring, int threads,
              struct sim_matches **out) __attribute__((warn_unused_result));

/* The score of one comparison, for error rates. `mate` is the place of the visitor in the gallery,
 * or SIM_NOBODY. */
static inline double sim_matches_compared(const struct sim_matches *matches, size_t probe,
                                          size_t person, size_t mate)
{
    const bool other = matches->stranger_score && mate != SIM_NOBODY && person != mate;
    return (other ? matches->stranger_score : matches->score)[probe * matches->n_people + person];
}

/* Finds the first comparison whose score is NaN, which no error rate can count: its probe and
 * person. False if there is none. */
bool sim_matches_find_nan(const struct sim_matches *matches, size_t *probe, size_t *person);

/* Frees it and what it holds. NULL is accepted. */
void sim_matches_free(struct sim_matches *matches);

#endif
