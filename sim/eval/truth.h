/* Where the landmarks really are: landmarks.csv of the recordings of a corpus. */
#ifndef SIM_EVAL_TRUTH_H
#define SIM_EVAL_TRUTH_H

#include <stdbool.h>

#include "core/landmark/landmark.h"
#include "core/math/vec.h"
#include "sim/recording/corpus.h"

/* Of one frame. Names other than the twelve are passed over. */
struct sim_truth {
    bool known[ISO_LANDMARKS];
    struct iso_vec3 point_mm[ISO_LANDMARKS]; /* camera frame; 0 where not known */
};

/* [sim_corpus_frames], in the order of captures; to be freed with free(). A recording without
 * landmarks.csv has frames of which nothing is known. A damaged landmarks.csv is -EBADMSG; -ENOMEM,
 * or an error of opening a recording. */
int sim_truth_read(const char *directory, const struct sim_corpus *corpus, struct sim_truth **out,
                   struct iso_fault *fault) __attribute__((warn_unused_result));

#endif
