/* Error rates of a site, estimated from the comparisons of the templates that are enrolled there.
 *
 * Each template of a person is compared as a probe with the person's other templates (mated), and
 * the first few with everybody else (non-mated). The scores are those of the metric alone, without
 * the comparison of surfaces that decides close scores at the door (core/match/rerank.h).
 *
 * The estimates are those of single templates, not of visits. They are somewhat too low, because
 * the metric was adapted to these people, and because all templates come from enrolments: a
 * stranger reaches a score somewhat more often than estimated, and on another day the same person
 * misses it more often. */
#ifndef ISO_FIRMWARE_SITE_SITE_ESTIMATE_H
#define ISO_FIRMWARE_SITE_SITE_ESTIMATE_H

#include "core/base/people_rate.h"
#include "firmware/site/site_generation.h"

enum {
    ISO_SITE_LEVELS = 3,       /* scores of 2, 3 and 4: those of the levels */
    ISO_SITE_LEVEL_LEAST = 2,  /* the score of the first of them */
    ISO_SITE_SAMPLE_MAX = 100, /* most people who are compared: those with the lowest numbers */
    ISO_SITE_PROBES_MAX = 3,   /* most templates of a person that are compared with others */
    ISO_SITE_PAIRS_MAX = 16,   /* most pairs that are kept: those of the highest scores */
};

/* Two people who look alike, by the highest score of a template of one with the other. */
struct iso_site_pair {
    int64_t person, other; /* numbers of the caller, person < other */
    double score;
};

struct iso_site_estimate {
    int people;   /* people who were compared */
    int repeated; /* of these, people with at least two templates */
    struct {
        double score;
        struct iso_people_rate same;   /* mated comparisons; an error is below the score */
        struct iso_people_rate others; /* non-mated ones, counted for both people
                                          (iso_people_rate_pair_interval); an error reaches it */
    } level[ISO_SITE_LEVELS];
    int n_pairs;
    struct iso_site_pair pair[ISO_SITE_PAIRS_MAX]; /* by falling score, then by rising numbers */
};

/* Estimates the rates with this metric: an adapted one, or (NULL) the shipped one. Takes up to
 * about half a second. -ECANCELED if the people have changed, -ENOMEM. */
int iso_site_estimate_make(struct iso_site_work *work, struct iso_site_shared *shared,
                           struct iso_site_estimate *out) __attribute__((warn_unused_result));

#endif
