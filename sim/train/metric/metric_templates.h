/* The templates of all corpora that a metric is learned from, and whose they are. Internal to
 * sim/train/metric. */
#ifndef SIM_TRAIN_METRIC_METRIC_TEMPLATES_H
#define SIM_TRAIN_METRIC_METRIC_TEMPLATES_H

#include <stdbool.h>
#include <stddef.h>

#include "core/base/fault.h"
#include "isotherm/metric.h"
#include "sim/lab/match/capture.h"

/* All zero: there are none yet. */
struct sim_metric_templates {
    size_t n; /* frames */
    struct iso_template *tmpl;
    size_t *person; /* of each, from 0 over all corpora */
    bool *usable;   /* whether the extractor made a template of the frame */
    size_t n_people;
    size_t first; /* frame of the corpus that is read */
};

/* Adds the frames of a corpus, and its origin and algorithm to those of the metric. -EINVAL for a
 * corpus whose people are of no origin, of several, or of one that the metric has already; -ENOMEM;
 * errors of reading the corpus and of sim_capture_all; each with a fault. */
int sim_metric_templates_read(struct sim_metric_templates *t, const char *directory,
                              const struct sim_capture_options *options, struct iso_metric *shape,
                              struct iso_fault *fault) __attribute__((warn_unused_result));

/* Forgets the frames that have no template. */
void sim_metric_templates_leave_usable(struct sim_metric_templates *t);

void sim_metric_templates_done(struct sim_metric_templates *t);

/* One person in five calibrates the scores; nothing else is learned from them. */
static inline bool sim_metric_is_held_out(size_t person)
{
    return person % 5 == 0;
}

#endif
