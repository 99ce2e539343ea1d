/* Trains the metric (isotherm/metric.h) on corpora of generated people.
 *
 * Every frame of every row goes through the extractor, as in an evaluation. A person is a subject
 * of a corpus; corpora share no people. One person in five is left out of the learning of the
 * axes and calibrates the scores afterwards: the metric's score and the fused score
 * (core/match/rerank.h). The mean face comes from all people. */
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

/* Sets all options except the corpora and the model: the upper landmarks, 150 dimensions, one
 * thread. */
struct sim_train_metric_options sim_train_metric_options_default(void);

/* Error rates of a score among the people held out. */
struct sim_train_scores {
    size_t n_mated, n_others;                /* comparisons */
    double fmr_at[3], false_non_match_at[3]; /* at scores 2, 3 and 4 */
};

struct sim_train_metric_report {
    /* All frames of the corpora; the templates that the axes are learned from, and their people. */
    size_t n_frames, n_templates, n_people;
    double explained;                      /* share of the variance that the dimensions hold */
    struct sim_train_scores metric, fused; /* `fused` uses fewer comparisons of strangers */
};

/* The same corpora make the same metric. -EINVAL for options out of range or a row without an
 * origin in its note ("POPULATION-SEED", its first word, as `generate` writes); -ENODATA for too
 * few people or comparisons; -EDOM as sim_metric_calibrate; errors of sim_corpus_read and
 * sim_capture_all; -ENOMEM; each with a fault. */
int sim_train_metric(const struct sim_train_metric_options *options, struct iso_metric **out,
                     struct sim_train_metric_report *report, struct iso_fault *fault)
    __attribute__((warn_unused_result));

#endif
