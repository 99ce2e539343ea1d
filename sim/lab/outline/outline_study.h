/* Measures whether the outline stream tells people apart: a recogniser of nearest neighbours learns
 * the frames of the gallery of a corpus and names the person of each probe. */
#ifndef SIM_LAB_OUTLINE_OUTLINE_STUDY_H
#define SIM_LAB_OUTLINE_OUTLINE_STUDY_H

#include <stddef.h>

#include "core/base/fault.h"
#include "core/base/proportion.h"
#include "sim/lab/outline/outline_features.h"

struct sim_outline_result {
    size_t people;  /* in the gallery */
    size_t learned; /* frames of the gallery */
    size_t probes;  /* frames of enrolled people */
    size_t right;   /* of them, how many were named rightly */
    /* The mean over people of the rate of right names, and its 95 % interval, from the people as
     * independent units (Student's t). Chance is 1 / people. */
    double rate;
    struct iso_interval interval;
};

/* One of the frames that the recogniser learns or names. */
struct sim_outline_sample {
    size_t subject; /* 0.. */
    struct sim_outline_features features;
};

/* Names each probe by the nearest gallery frame: the Euclidean distance of the features, each with
 * the mean of its gallery subtracted and divided by the standard deviation between frames of the
 * same person, so that features that differ within a person count less. -EINVAL if there are no
 * probes or fewer than two people, -ENOMEM. */
int sim_outline_recognise(const struct sim_outline_sample *gallery, size_t n_gallery,
                          const struct sim_outline_sample *probes, size_t n_probes,
                          struct sim_outline_result *out) __attribute__((warn_unused_result));

/* Runs the extractor on the frames of a corpus and the recogniser on their outlines, one view after
 * the other: results[SIM_OUTLINE_VIEWS]. Frames without a pose are left out. Errors of reading the
 * model and the corpus, and of sim_outline_recognise. */
int sim_outline_study(const char *corpus, const char *model, struct sim_outline_result *results,
                      struct iso_fault *fault) __attribute__((warn_unused_result));

#endif
