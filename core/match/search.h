/* 1:N search: a probe against every template of a gallery, by metric or by distance. */
#ifndef ISO_CORE_MATCH_SEARCH_H
#define ISO_CORE_MATCH_SEARCH_H

#include <stdint.h>

#include "core/match/cohort.h"
#include "core/match/rerank.h"
#include "isotherm/index.h"
#include "isotherm/metric.h"

/* Refers to a template; the gallery keeps it alive. */
struct iso_search_entry {
    int64_t person; /* the caller's identifier; several entries may share it */
    const struct iso_template *tmpl;
};

/* The best hits by falling score, one a person (its best template): at most `capacity` of them are
 * written (room for scratch until the search has succeeded) and *n_hits says how many. An empty
 * gallery gives none. Entries that have too few points in common with the probe cannot be hits.
 * -EINVAL if algorithms differ or options are out of range, -ENODATA if the probe itself has too
 * few points for the cohort. */
int iso_search(struct iso_icp_workspace *work, const struct iso_search_entry *entries,
               int n_entries, const struct iso_template *probe, const struct iso_cohort *cohort,
               const struct iso_match_options *options, struct iso_search_hit *hits, int capacity,
               int *n_hits) __attribute__((warn_unused_result));

/* The same by the learned metric: a person's score rests on all of that person's templates, which
 * stand side by side in `entries`. The ISO_RERANK_CANDIDATES best are looked at again (rerank.h);
 * hits are some of them, by their fused scores. -EINVAL if algorithms differ, -ENODATA if the probe
 * has too few points. */
int iso_search_by_metric(struct iso_rerank_workspace *work, const struct iso_search_entry *entries,
                         int n_entries, const struct iso_template *probe,
                         const struct iso_metric *metric, struct iso_search_hit *hits, int capacity,
                         int *n_hits) __attribute__((warn_unused_result));

#endif
