/* Trains the metric (isotherm/metric.h) on corpora of generated people.
 *
 * Every usable frame of every row goes through the extractor, as in an evaluation. A person is a
 * subject of a corpus; corpora share no people. One person in five is left out of the learning
 * and calibrates the scores afterwards: the metric's score and the fused score
 * (core/match/rerank.h). */
#ifndef SIM_TRAIN_METRIC_TRAIN_METRIC_H
#define SIM_TRAIN_METRIC_TRAIN_METRIC_H

#include "core/base/fault.h"
#include "isotherm/extract.h"
#include "isotherm/metric.h"

enum { SIM_METRIC_CORPORA_MAX = ISO_METRIC_ORIGINS_MAX };

struct sim_train_metric_options {
    const char *corpora[SIM_METRIC_CORPORA_MAX]; /* directories */
    int n_corpora;
    const struct iso_head_model *model;
    struct iso_extract_options extract;
    uint32_t landmarks; /* as in struct iso_metric */
    int n_dimensions, threads;
};

/* Sets all options except the corpora, the model and the threads: the upper landmarks, 150
 * dimensions. */
struct sim_train_metric_options sim_train_metric_options_default(void);

/* Error rates of a score among the people held out. */
struct sim_train_scores {
    size_t n_mated, n_others;                /* comparisons */
    double fmr_at[3], false_non_match_at[3]; /* at scores 2, 3 and 4 */
};

struct sim_train_metric_report {
    size_t n_frames, n_templates, n_people; /* frames; usable ones; people with a template */
    double explained;                       /* share of the variance that the dimensions hold */
    struct sim_train_scores metric, fused;  /* `fused` uses fewer comparisons of strangers */
};

/* The same corpora make the same metric. -EINVAL for options out of range or a row without an
 * origin in its note ("POPULATION-SEED", its first word, as `generate` writes); -ENODATA for too
 * few people; errors of sim_corpus_read and sim_capture_all; -ENOMEM; each with a fault. */
int sim_train_metric(const struct sim_train_metric_options *options, struct iso_metric **out,
                     struct sim_train_metric_report *report, struct iso_fault *fault)
    __attribute__((warn_unused_result));

#endif
