/* The part of a gallery (gallery.h) that is in memory: people, and the data for comparisons.
 * Internal to the gallery.
 *
 * With a metric the data is an index of vectors, and templates are in the database alone. Without
 * one it is the usable templates themselves. Changes come in two steps: everything that can fail is
 * prepared before the database's transaction, and the step after it cannot fail. */
#ifndef ISO_FIRMWARE_GALLERY_GALLERY_MEMORY_H
#define ISO_FIRMWARE_GALLERY_GALLERY_MEMORY_H

#include <stdbool.h>

#include "firmware/gallery/gallery_access.h"
#include "firmware/gallery/gallery_db.h"
#include "firmware/site/site_index.h"

struct iso_gallery_memory {
    uint32_t algorithm;
    const struct iso_metric *metric; /* NULL: compared by distance */
    struct iso_person *people;       /* in ascending order of id */
    size_t n_people, people_capacity;
    size_t same_names; /* how many names had the key of another person's name when loaded */
    bool adapt;        /* the metric adapts to the people (site_index.h) */
    /* False if none of the loaded templates was learned at a visit, and none was added since. */
    bool may_be_learned;
    struct iso_site_index *site;          /* only with a metric */
    char sensor[ISO_TEMPLATE_SENSOR_MAX]; /* class of the running sensor; "": not known */
    struct iso_search_entry *entries;     /* only without a metric, in the order of people */
    size_t n_entries, entries_capacity;
    struct iso_gallery_access_list access;
};

/* Loads the whole database, within a transaction or not. `out` is written on success; done frees
 * it. The listener counts people. (gallery_load.c) */
int iso_gallery_memory_load(struct iso_gallery_db *db, uint32_t algorithm,
                            const struct iso_metric *metric, bool adapt,
                            const struct iso_work_listener *listener,
                            struct iso_gallery_memory *out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* The same when the gallery is opened, and not within a transaction. Stores the vectors that had to
 * be made (iso_gallery_db_store_vectors), if there are many of them. (gallery_load.c) */
int iso_gallery_memory_start(struct iso_gallery_db *db, const struct iso_gallery_options *options,
                             struct iso_gallery_memory *out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Sets the class of the running sensor (iso_site_index_set_sensor).
 * (gallery_look.c) */
void iso_gallery_memory_set_sensor(struct iso_gallery_memory *memory, const char *sensor);

/* Wipes and frees everything. */
void iso_gallery_memory_done(struct iso_gallery_memory *memory);

/* A usable template in the form in which it is kept. */
struct iso_gallery_kept {
    struct iso_template *tmpl;            /* only without a metric */
    struct iso_metric_vector vector;      /* with a metric; empty if there are too few points */
    int64_t number;                       /* of the template; the caller of prepare sets it */
    char sensor[ISO_TEMPLATE_SENSOR_MAX]; /* that made the template */
};

/* Makes this form from a serialised template, and makes room for it and for one more person. Errors
 * of iso_template_parse; -EINVAL of another algorithm or not fit for the metric, -ENOMEM. */
int iso_gallery_memory_prepare(struct iso_gallery_memory *memory, const void *bytes, size_t size,
                               struct iso_gallery_kept *out) __attribute__((warn_unused_result));

/* The two halves of that for a gallery that is being loaded: makes the form and room for the
 * template, so that the people stay at their addresses, and adds it to the memory. Nobody has more
 * templates than an index takes. Errors of iso_gallery_memory_prepare, and of
 * iso_site_index_add. */
int iso__gallery_memory_read(struct iso_gallery_memory *memory, const void *bytes, size_t size,
                             struct iso_gallery_kept *out) __attribute__((warn_unused_result));
int iso__gallery_memory_insert(struct iso_gallery_memory *memory, int64_t person,
                               struct iso_gallery_kept *kept) __attribute__((warn_unused_result));

/* Wipes and frees what is still in it. */
void iso_gallery_memory_discard(struct iso_gallery_kept *kept);

/* Makes room for n prepared templates (1 or more), and for n more people. -ENOMEM. */
int iso_gallery_memory_reserve(struct iso_gallery_memory *memory, int n)
    __attribute__((warn_unused_result));
int iso_gallery_memory_reserve_people(struct iso_gallery_memory *memory, size_t n)
    __attribute__((warn_unused_result));

/* Puts a row in place of that of its person, or adds a person; templates that cannot be searched
 * are only counted. The caller has made room. (gallery_apply.c) */
void iso_gallery_memory_put_person(struct iso_gallery_memory *memory, const struct iso_person *row,
                                   uint32_t unusable);

/* Adds the prepared template to this person. A person who is not known yet is added with the values
 * of the row. Limits and counts are updated. */
void iso_gallery_memory_add(struct iso_gallery_memory *memory, const struct iso_person *row,
                            struct iso_gallery_kept *kept);

/* Removes a person with all templates. */
void iso_gallery_memory_remove(struct iso_gallery_memory *memory, int64_t person);

/* Returns NULL if there is no such person. */
struct iso_person *iso_gallery_memory_find(const struct iso_gallery_memory *memory, int64_t person);

#endif
