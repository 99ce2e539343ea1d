/* Where the landmarks really are: landmarks.csv of the recordings of a corpus. */
#ifndef SIM_LAB_MATCH_TRUTH_H
#define SIM_LAB_MATCH_TRUTH_H

#include <stdbool.h>

#include "drivers/recording/recording.h"
#include "isotherm/landmark.h"
#include "isotherm/vec.h"
#include "sim/corpus/corpus.h"

/* Of one frame. Names other than the twelve are passed over. */
struct sim_truth {
    bool known[ISO_LANDMARKS];
    struct iso_vec3 point_mm[ISO_LANDMARKS]; /* camera frame; 0 where not known */
};

/* [iso_recording_frames] of one recording; to be freed with free(). Without landmarks.csv nothing
 * is known of any frame. A damaged landmarks.csv is -EBADMSG; -ENOMEM. */
int sim_truth_of_recording(const struct iso_recording *recording, struct sim_truth **out,
                           struct iso_fault *fault) __attribute__((warn_unused_result));

/* [sim_corpus_frames], in the order of captures; to be freed with free(). Errors of the former and
 * of opening a recording. */
int sim_truth_read(const char *directory, const struct sim_corpus *corpus, struct sim_truth **out,
                   struct iso_fault *fault) __attribute__((warn_unused_result));

#endif
