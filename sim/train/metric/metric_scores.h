/* Calibrates the scores of a metric with the people held out. Internal to sim/train/metric. */
#ifndef SIM_TRAIN_METRIC_METRIC_SCORES_H
#define SIM_TRAIN_METRIC_METRIC_SCORES_H

#include "sim/train/metric/metric_templates.h"
#include "sim/train/metric/train_metric.h"

/* Compares the people held out with one another. Fits gain and bias of the metric's score, and
 * the weights of reranking, to the scores of strangers, and lowers all scores for caution. Reports
 * the error rates by the metric alone and with reranking. The axes must be set. -ENODATA for too
 * few comparisons, -EDOM as sim_metric_calibrate, -ENOMEM. */
int sim_metric_learn_scores(const struct sim_metric_templates *t, int threads,
                            struct iso_metric *metric, struct sim_train_metric_report *report)
    __attribute__((warn_unused_result));

#endif
