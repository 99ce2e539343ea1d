/* 1:N search: a probe against every template of a gallery.
 *
 * The index holds references, not copies; the gallery's owner keeps the templates alive and tells the index of changes. */
#ifndef ISO_CORE_MATCH_SEARCH_H
#define ISO_CORE_MATCH_SEARCH_H

#include <stdint.h>

#include "core/match/score.h"

struct iso_search_entry {
    int64_t person;                    /* the caller's identifier; several entries may share it */
    const struct iso_template *tmpl;
};

struct iso_search_hit {
    int64_t person;
    double distance_mm;
    double score; /* cohort-normalised; higher is more alike */
};

/* The best hits, one per person (its best template), by falling score: at most `capacity` are
 * written. Returns how many people were compared (may exceed capacity), 0 for an empty gallery; -EINVAL if a template's
 * algorithm differs from the probe's, -ENODATA if the probe has too few points. */
int iso_search(const struct iso_search_entry *entries, int n_entries, const struct iso_template *probe,
               const struct iso_cohort *cohort, const struct iso_match_options *options,
               struct iso_search_hit *hits, int capacity) __attribute__((warn_unused_result));

#endif
