/* The candidates that a probe is compared with: templates, or an index of people. It only refers
 * to them: they must not change while the list is used. */
#ifndef ISO_FIRMWARE_GALLERY_CANDIDATE_LIST_H
#define ISO_FIRMWARE_GALLERY_CANDIDATE_LIST_H

#include <stdbool.h>
#include <stdint.h>

#include "core/base/fault.h"
#include "core/match/search.h"
#include "firmware/site/site_index.h"
#include "isotherm/index.h"

/* All zero: there are no candidates. */
struct iso_candidate_list {
    const struct iso_search_entry *entries; /* the entries of one person are consecutive */
    int n_entries;
    const struct iso_index *index;     /* if not NULL, it is used instead of the entries */
    const struct iso_site_index *site; /* the site of the index (site_index.h), whose metric gives
                                          the best people their scores; NULL: the index does */
    int64_t person;                    /* only this person of the index; 0: all people */

    /* OPTIONAL, with an index: a function that opens the templates of one of its people, as
     * iso_gallery_templates does, and a number that changes whenever they may have changed. NULL:
     * there is no reranking. */
    int (*templates)(void *owner, int64_t person, struct iso_template *out, int capacity, int *n,
                     struct iso_fault *fault);
    void *owner;
    uint64_t version;
};

/* Whether there are no candidates. */
static inline bool iso_candidates_none(const struct iso_candidate_list *among)
{
    return !among->index && among->n_entries == 0;
}

#endif
