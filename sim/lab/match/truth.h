/* True positions of landmarks, from landmarks.csv of the recordings of a corpus. */
#ifndef SIM_LAB_MATCH_TRUTH_H
#define SIM_LAB_MATCH_TRUTH_H

#include <stdbool.h>

#include "drivers/recording/recording.h"
#include "isotherm/landmark.h"
#include "isotherm/vec.h"
#include "sim/corpus/corpus.h"

/* The truth of one frame. Names other than the twelve are ignored. */
struct sim_truth {
    bool known[ISO_LANDMARKS];
    struct iso_vec3 point_mm[ISO_LANDMARKS]; /* camera frame; 0 where not known */
};

/* Reads the truth of each frame of one recording, [iso_recording_frames]; free it with free().
 * Without landmarks.csv no landmark is known. -EBADMSG for a damaged landmarks.csv; -ENOMEM. */
int sim_truth_of_recording(const struct iso_recording *recording, struct sim_truth **out,
                           struct iso_fault *fault) __attribute__((warn_unused_result));

/* Reads the truth of each frame of a corpus, [sim_corpus_frames], in the order of captures; free
 * it with free(). Errors of sim_recording_open and sim_truth_of_recording; -ENOMEM. */
int sim_truth_read(const char *directory, const struct sim_corpus *corpus, struct sim_truth **out,
                   struct iso_fault *fault) __attribute__((warn_unused_result));

#endif
