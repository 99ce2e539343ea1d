/* The people who are enrolled in an evaluation, and their templates. */
#ifndef SIM_LAB_MATCH_GALLERY_H
#define SIM_LAB_MATCH_GALLERY_H

#include <stdbool.h>
#include <stdint.h>

#include "sim/lab/match/acquire.h"

/* The people of the rows with role gallery, in the manifest's order. */
struct sim_gallery {
    size_t n_people, n_templates;
    const char **names;                    /* [n_people]; they belong to the corpus */
    size_t *n_templates_of;                /* [n_people]; 0: failed to enrol */
    const struct iso_template **templates; /* [n_templates]; they belong to the samples */
    size_t *person;                        /* [n_templates] */
    size_t *sample;       /* [n_templates]: index of the sample in the acquisition */
    const char *teaching; /* kind of sensor whose templates teach the metric; NULL: every kind */
};

/* Enrols the first `limit` people (0: all). The gallery refers to the corpus and the acquisition.
 * -ENOMEM. */
int sim_gallery_new(const struct sim_corpus *corpus, const struct sim_acquisition *acquisition,
                    size_t limit, struct sim_gallery **out) __attribute__((warn_unused_result));

/* A gallery of those people whose place in `keep` [n_people] is true, in the same order.
 * -ENOMEM. */
int sim_gallery_part(const struct sim_gallery *gallery, const bool *keep, struct sim_gallery **out)
    __attribute__((warn_unused_result));

/* Frees it and what it holds. NULL is accepted. */
void sim_gallery_free(struct sim_gallery *gallery);

/* The index of a person in the gallery, or SIM_NOBODY. */
#define SIM_NOBODY SIZE_MAX
size_t sim_gallery_find(const struct sim_gallery *gallery, const char *name);

#endif
