/* What a metric learns of the shape of faces: the mean, and the axes along which people differ.
 * Internal to sim/train/metric. */
#ifndef SIM_TRAIN_METRIC_METRIC_SHAPE_H
#define SIM_TRAIN_METRIC_METRIC_SHAPE_H

#include "sim/train/metric/metric_templates.h"
#include "sim/train/metric/train_metric.h"

/* Chooses every second node of the upper face, like the squares of one colour of a chessboard, if
 * nearly all templates have it. The nodes in between have little to add, because the surface is
 * smoothed. */
void sim_metric_choose_nodes(const struct sim_metric_templates *t, struct iso_metric *shape);

/* The mean curves and the mean heights of the upper face. -ENOMEM. */
int sim_metric_learn_means(const struct sim_metric_templates *t, struct iso_metric *metric)
    __attribute__((warn_unused_result));

/* The axes, from the residuals of all people but those held out; says in the report how many people
 * and templates these are and how much is explained. Needs the means. Errors of sim_metric_learn,
 * -ENOMEM. */
int sim_metric_learn_axes(const struct sim_metric_templates *t, struct iso_metric *metric,
                          struct sim_train_metric_report *report)
    __attribute__((warn_unused_result));

#endif
