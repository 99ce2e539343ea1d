/* What an appliance gains by learning from its site (core/match/site.h). The people of a corpus are
 * split: the site statistics are learned from all acquired samples of some people, and the searches
 * of the others are judged with the adapted metric, with only the others enrolled. Every
 * split counts both ways: half of the people, rounded down, are learned from, and then the others.
 * All splits are made if there are at most SIM_SITE_SPLITS, otherwise that many at random, the same
 * ones in each run.
 *
 * The statistics never contain captures of the two people who are compared: neither those of the
 * visitor nor those of the other person. The visitor is a stranger to the site.
 *
 * Comparisons of all splits are pooled. A comparison is in several splits, so that intervals from
 * counts would be too narrow. The intervals resample the people of the probes (Bolle, Ratha and
 * Pankanti 2004). */
#ifndef SIM_LAB_EVAL_SITE_SPLIT_H
#define SIM_LAB_EVAL_SITE_SPLIT_H

#include "sim/lab/match/match.h"
#include "sim/lab/measure/calibration.h"
#include "sim/lab/measure/det.h"

enum { SIM_SITE_SPLITS = 40, SIM_SITE_SCORES = 3 };

/* The rates of wrong decisions at one score. */
struct sim_site_rate {
    double score;     /* 2, 3, 4: the promised FMRs are 1e-2 to 1e-4 */
    double fmr, fnmr; /* 0..1; NaN without comparisons */
    struct sim_interval fmr_interval, fnmr_interval;
};

struct sim_site_split {
    size_t people, learned, splits; /* `learned`: people that the smaller half has */
    struct sim_rate refused;        /* mated searches that were not acquired; each counts once */
    struct sim_rate rank_1;         /* of acquired mated searches, pooled */
    double eer, eer_with_refused;   /* the second counts a refused search as a false non-match */
    struct sim_site_rate at[SIM_SITE_SCORES];
    struct sim_calibration calibration;     /* of the pooled comparisons */
    double offset, expected, growth, share; /* means over the splits: struct iso_site_summary */
};

/* `scoring` has a metric, which must outlive the call; the other arguments are those of sim_match.
 * -EINVAL for fewer than four people with templates, -ENOMEM, and the errors of sim_match and of
 * iso_site_adapt. */
int sim_site_split(const struct sim_corpus *corpus, struct sim_acquisition *acquisition,
                   const struct sim_gallery *gallery, const struct sim_scoring *scoring,
                   int threads, struct sim_site_split *out) __attribute__((warn_unused_result));

#endif
