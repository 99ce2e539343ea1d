/* 1:N search: a probe against every template of a gallery, by metric or by distance. */
#ifndef ISO_CORE_MATCH_SEARCH_H
#define ISO_CORE_MATCH_SEARCH_H

#include <stdint.h>

#include "core/match/cohort.h"
#include "core/match/rerank.h"
#include "isotherm/index.h"
#include "isotherm/metric.h"

/* One template of a gallery. The template must exist until the search has ended. */
struct iso_search_entry {
    int64_t person; /* the caller's identifier; several entries may share it */
    const struct iso_template *tmpl;
};

/* Sorts n hits by falling score, and people of equal score by rising number. */
void iso_search_sort(struct iso_search_hit *hits, size_t n);

/* Finds the best hits by distance, sorted by falling score; a person has one hit, by the best
 * template. hits [capacity] receives them; it is also used as working memory, so that its contents
 * are undefined after an error. *n_hits is their number; 0 for an empty gallery. Entries that have
 * too few points in common with the probe cannot be hits. -EINVAL if algorithms differ or options
 * are out of range, -ENODATA if the probe has too few points in common with the cohort. */
int iso_search(struct iso_icp_workspace *work, const struct iso_search_entry *entries,
               int n_entries, const struct iso_template *probe, const struct iso_cohort *cohort,
               const struct iso_match_options *options, struct iso_search_hit *hits, int capacity,
               int *n_hits) __attribute__((warn_unused_result));

/* The same by the learned metric. A person's score depends on all templates of the person; their
 * entries must follow each other in `entries`. The ISO_RERANK_CANDIDATES best people are reranked
 * (rerank.h), and hits are found among these only, by their fused scores. -EINVAL if algorithms
 * differ, -ENODATA if the probe has too few points. */
int iso_search_by_metric(struct iso_rerank_workspace *work, const struct iso_search_entry *entries,
                         int n_entries, const struct iso_template *probe,
                         const struct iso_metric *metric, struct iso_search_hit *hits, int capacity,
                         int *n_hits) __attribute__((warn_unused_result));

#endif
