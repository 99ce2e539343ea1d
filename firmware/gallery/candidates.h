/* Whom a probe is compared with: some templates, or an index of people. Refers to what is
 * elsewhere, which stays as it is as long as this is used. */
#ifndef ISO_FIRMWARE_GALLERY_CANDIDATES_H
#define ISO_FIRMWARE_GALLERY_CANDIDATES_H

#include <stdbool.h>
#include <stdint.h>

#include "core/base/fault.h"
#include "core/match/index.h"
#include "core/match/search.h"

/* All zero: nobody. */
struct iso_candidates {
    const struct iso_search_entry *entries; /* those of one person side by side */
    int n_entries;
    const struct iso_index *index; /* if not NULL: instead of the entries ... */
    int64_t person;                /* ... this person of it alone; 0: everybody */

    /* OPTIONAL, with an index: what opens the templates of one of its people, as
     * iso_gallery_templates does, and a number that is another one whenever they may have changed.
     * NULL: nobody is looked at again. */
    int (*templates)(void *keeper, int64_t person, struct iso_template *out, int capacity, int *n,
                     struct iso_fault *fault);
    void *keeper;
    uint64_t version;
};

static inline bool iso_candidates_none(const struct iso_candidates *among)
{
    return !among->index && among->n_entries == 0;
}

#endif
