/* A sealed gallery on the disk with many people, for benchmarks. */
#ifndef TESTS_BENCH_ENROLLED_H
#define TESTS_BENCH_ENROLLED_H

#include "firmware/gallery/gallery.h"

/* The number of templates that a person of such a gallery has at most. */
enum { BENCH_TEMPLATES_MAX = 16 };

/* Template number `number` of person `person`. */
typedef struct iso_template bench_person_function(const void *context, size_t person,
                                                  size_t number);

/* Opens or makes the keys of the gallery at `path`, in the files PATH.keys and PATH.key. Errors of
 * iso_key_ring_open. */
int bench_ring_open(const char *path, struct iso_key_ring **out, struct iso_fault *fault);

/* Opens or makes the gallery at `path` with room for `people`. Errors of iso_gallery_open. */
int bench_gallery_open(const char *path, size_t people, const struct iso_metric *metric,
                       struct iso_key_ring *ring, struct iso_gallery **out,
                       struct iso_fault *fault);

/* Enrols "person 0", "person 1" and so on with 1 to BENCH_TEMPLATES_MAX templates each, at_once
 * people in one import (1 or more). -ENOMEM and errors of iso_gallery_import. */
int bench_gallery_fill(struct iso_gallery *gallery, size_t people, size_t at_once, size_t templates,
                       bench_person_function *make, const void *context, struct iso_fault *fault);

/* Deletes the files of the gallery and its keys. */
void bench_gallery_remove(const char *path);

#endif
