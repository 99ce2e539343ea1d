/* A corpus that supplies tables, and its results so far. Internal to sim/shapes/study. */
#ifndef SIM_SHAPES_STUDY_TABLES_CORPUS_H
#define SIM_SHAPES_STUDY_TABLES_CORPUS_H

#include <limits.h>

#include "sim/shapes/study/retrieve.h"
#include "sim/shapes/study/tables.h"

enum { SIM_TABLES_METHODS_MAX = 16, SIM_TABLES_CACHE_MAX = 32 };

/* All zero except the directory: not opened yet. */
struct sim_tables_corpus {
    const char *directory;
    struct sim_shape_manifest *manifest;
    /* The methods that its tables need. */
    const struct iso_shape_method *method[SIM_TABLES_METHODS_MAX];
    int n_methods;
    char kept[PATH_MAX]; /* where descriptions are kept, or empty */
    struct sim_bank_options how;
    struct sim_bank *items, *distorted[SIM_DISTORTIONS][SIM_DISTORTION_LEVELS];
    int32_t *query_row; /* the shapes to distort */
    int32_t n_queries;
    struct {
        int method, size;
        struct sim_features *features;
    } cache[SIM_TABLES_CACHE_MAX];
    int n_cached;
};

/* Requests a method that a table needs, before the corpus is opened. */
void sim_tables_corpus_ask_method(struct sim_tables_corpus *corpus, const char *name);

/* Reads the corpus, describes its shapes by the requested methods, and prints the duration.
 * Errors of reading and of sim_bank_new, with a fault; -ENOMEM without one. */
int sim_tables_corpus_open(struct sim_tables_corpus *corpus,
                           const struct sim_tables_options *options, FILE *out,
                           struct iso_fault *fault) __attribute__((warn_unused_result));

/* Frees all content of the struct, also for a corpus that could not be opened. */
void sim_tables_corpus_close(struct sim_tables_corpus *corpus);

/* The queries of a row: the items, or some of them distorted. Distorted items are described on
 * the first request. Errors of sim_bank_new. */
int sim_tables_corpus_queries(struct sim_tables_corpus *corpus, struct sim_distortion distortion,
                              const struct sim_bank **out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* The features by a requested method; the corpus owns them. -ENOSPC if it holds too many; errors
 * of sim_features_new. */
int sim_tables_corpus_features(struct sim_tables_corpus *corpus, const char *method, int size,
                               uint64_t seed, struct sim_features **out)
    __attribute__((warn_unused_result));

#endif
