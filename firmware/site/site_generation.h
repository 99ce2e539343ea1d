/* A metric that is adapted to the people of a site, and the index by it. Internal to
 * firmware/site; the thread of site_index.h computes them. */
#ifndef ISO_FIRMWARE_SITE_SITE_GENERATION_H
#define ISO_FIRMWARE_SITE_SITE_GENERATION_H

#include <pthread.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "core/match/metric_vector.h"
#include "core/match/site.h"
#include "isotherm/index.h"

/* A person with the vectors of all templates by the shipped metric. Only n and mean of a vector are
 * set. Biometric. */
struct iso_site_person {
    int64_t number;
    int n;
    struct iso_metric_vector captures[ISO_INDEX_TEMPLATES_MAX];
};

/* Reads the people of a site one after the other. */
struct iso_site_reader {
    /* Copies the person who begins at row *at, which is 0 for the first one, and moves *at to the
     * next one: with all templates, or (`teaching`) the next person who has templates that teach,
     * with these alone. Returns 1; 0 if there is nobody left; -ECANCELED if the people have
     * changed. */
    int (*next)(void *context, bool teaching, size_t *at, struct iso_site_person *out);
    void *context;
};

/* An adapted metric with one owner or several owners, in different threads. The thread that
 * searches is the only one that changes it (iso_site_shared_forget). So that thread reads it
 * without the mutex, and every other thread holds the mutex while it computes a score. */
struct iso_site_shared {
    struct iso_site_metric adapted;
    pthread_mutex_t mutex; /* held for some ten microseconds */
    atomic_int owners;
};

struct iso_site_generation {
    struct iso_site_shared *shared; /* NULL: the shipped metric */
    struct iso_index *index;
    struct iso_site_summary summary;
};

/* One computation: what it reads, and room for it. */
struct iso_site_work {
    const struct iso_metric *metric; /* the shipped one */
    struct iso_metric_steps steps;   /* of that metric */
    struct iso_site_reader reader;
    struct iso_site_person person; /* room for the person who is read */
};

/* Computes the statistics, the metric and the index. -ECANCELED if the people have changed, -EDOM,
 * -ENOMEM; then *out is all zero. The person is wiped at the end. */
int iso_site_generation_make(struct iso_site_work *work, struct iso_site_generation *out)
    __attribute__((warn_unused_result));

/* Makes the generation by the shipped metric, which has learned nothing. It needs less memory than
 * iso_site_generation_make(). -ECANCELED, -ENOMEM; then *out is all zero. The person is wiped. */
int iso_site_generation_ship(struct iso_site_work *work, struct iso_site_generation *out)
    __attribute__((warn_unused_result));

/* Wipes and frees a generation, which may be all zero, and gives up its metric. */
void iso_site_generation_free(struct iso_site_generation *generation);

/* Becomes one more owner of the metric, and returns it; NULL is accepted. iso_site_shared_free()
 * ends it. The last owner wipes and frees the metric. */
struct iso_site_shared *iso_site_shared_keep(struct iso_site_shared *shared);
void iso_site_shared_free(struct iso_site_shared *shared);

/* Removes a person's own share (iso_site_metric_forget). NULL is accepted. */
void iso_site_shared_forget(struct iso_site_shared *shared, int64_t person);

/* Computes the vector of one capture by this metric: the adapted one, or (NULL) the shipped one. */
void iso_site_capture(const struct iso_site_work *work, const struct iso_site_shared *shared,
                      const struct iso_metric_vector *capture, struct iso_metric_vector *out);

#endif
