/* Learns the shape of faces for a metric: the mean, and the axes along which people differ. The
 * people held out take part in none of it (sim_metric_is_held_out).
 * Internal to sim/train/metric. */
#ifndef SIM_TRAIN_METRIC_METRIC_SHAPE_H
#define SIM_TRAIN_METRIC_METRIC_SHAPE_H

#include "sim/train/metric/metric_templates.h"
#include "sim/train/metric/train_metric.h"

/* Takes every second node of the upper face, like the squares of one colour on a chessboard, and
 * chooses those that nearly all templates have. The nodes in between add little, because the
 * surface is smoothed. */
void sim_metric_choose_nodes(const struct sim_metric_templates *t, struct iso_metric *shape);

/* Computes the mean curves and the mean heights of the upper face. -ENOMEM. */
int sim_metric_learn_means(const struct sim_metric_templates *t, struct iso_metric *metric)
    __attribute__((warn_unused_result));

/* Computes the axes from the residuals. The report gets the
 * number of these people and templates and the explained share of the variance. The means must
 * be set. Errors of sim_metric_learn, -ENOMEM. */
int sim_metric_learn_axes(const struct sim_metric_templates *t, struct iso_metric *metric,
                          struct sim_train_metric_report *report)
    __attribute__((warn_unused_result));

#endif
