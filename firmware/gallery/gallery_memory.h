/* What a gallery (gallery.h) keeps in memory: people, and what their templates are compared by.
 * Internal to the gallery.
 *
 * With a metric that is an index of vectors, and templates are in the database alone; without one
 * it is the usable templates themselves. Changes come in two steps: what can fail is prepared
 * before the database's transaction, and what follows it cannot fail. */
#ifndef ISO_FIRMWARE_GALLERY_GALLERY_MEMORY_H
#define ISO_FIRMWARE_GALLERY_GALLERY_MEMORY_H

#include "firmware/gallery/gallery_db.h"

struct iso_gallery_memory {
    uint32_t algorithm;
    const struct iso_metric *metric; /* NULL: by distance */
    struct iso_person *people;       /* by rising id */
    size_t n_people, people_capacity;
    size_t same_names;                /* names that were another's by their keys, when loaded */
    struct iso_index *index;          /* with a metric */
    struct iso_search_entry *entries; /* without one, in the order of people */
    size_t n_entries, entries_capacity;
};

/* All of the database, within a transaction or not. `out` is written on success; done frees it. The
 * listener is told of people. */
int iso_gallery_memory_load(struct iso_gallery_db *db, uint32_t algorithm,
                            const struct iso_metric *metric,
                            const struct iso_work_listener *listener,
                            struct iso_gallery_memory *out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Wipes and frees everything. */
void iso_gallery_memory_done(struct iso_gallery_memory *memory);

/* A usable template as it will be kept. */
struct iso_gallery_kept {
    struct iso_template *tmpl;       /* without a metric */
    struct iso_metric_vector vector; /* with one; of no template if it has too few points */
};

/* Makes that of a serialised template, and room for it and for one more person. As
 * iso_template_parse; -EINVAL of another algorithm or not fit for the metric, -ENOMEM. */
int iso_gallery_memory_prepare(struct iso_gallery_memory *memory, const void *bytes, size_t size,
                               struct iso_gallery_kept *out) __attribute__((warn_unused_result));
void iso_gallery_memory_discard(struct iso_gallery_kept *kept);

/* Takes over what was prepared, for this person; who is not known yet comes in, with what the
 * row says. Limits and counts follow. */
void iso_gallery_memory_add(struct iso_gallery_memory *memory, const struct iso_person *row,
                            struct iso_gallery_kept *kept);

void iso_gallery_memory_remove(struct iso_gallery_memory *memory, int64_t person);

/* NULL if there is no such person. */
struct iso_person *iso_gallery_memory_find(const struct iso_gallery_memory *memory, int64_t person);

#endif
