/* The templates of all corpora for the training of a metric, and their people. Internal to
 * sim/train/metric. */
#ifndef SIM_TRAIN_METRIC_METRIC_TEMPLATES_H
#define SIM_TRAIN_METRIC_METRIC_TEMPLATES_H

#include <stdbool.h>
#include <stddef.h>

#include "core/base/fault.h"
#include "isotherm/metric.h"
#include "sim/lab/match/capture.h"

/* All zero: no templates yet. */
struct sim_metric_templates {
    size_t n; /* frames */
    struct iso_template *tmpl;
    size_t *person; /* person of each frame, numbered from 0 over all corpora */
    bool *usable;   /* whether the extractor made a template of the frame */
    size_t n_people;
    size_t first; /* first frame of the corpus that is being read */
};

/* Adds the frames of a corpus. Adds the corpus's origin to those of `shape`, and sets the
 * algorithm of `shape`. -EINVAL for a corpus whose people have no origin, several origins, or an
 * origin that `shape` already has; -ENOMEM; errors of reading the corpus and of sim_capture_all;
 * each with a fault. */
int sim_metric_templates_read(struct sim_metric_templates *t, const char *directory,
                              const struct sim_capture_options *options, struct iso_metric *shape,
                              struct iso_fault *fault) __attribute__((warn_unused_result));

/* Removes the frames without a template. */
void sim_metric_templates_leave_usable(struct sim_metric_templates *t);

/* Releases what it holds. */
void sim_metric_templates_done(struct sim_metric_templates *t);

/* Whether a person is held out. One person in five calibrates the scores and takes no part in
 * anything else: nodes, means and axes come from the other people. */
static inline bool sim_metric_is_held_out(size_t person)
{
    return person % 5 == 0;
}

#endif
