/* Chooses frames of a study and draws them. */
#ifndef SIM_LAB_LANDMARKS_STUDY_PICTURES_H
#define SIM_LAB_LANDMARKS_STUDY_PICTURES_H

#include "sim/lab/landmarks/study.h"

struct sim_chosen_frame {
    size_t number; /* index among the measurement's frames */
    size_t rank;   /* 1: the worst, 2: the next; 0: the first of its outcome and kind */
};

/* Lists first the n_worst fitted frames of people with the largest mean error (without the constant
 * offsets), worst first. Then come, in the manifest's order, the first frame of each outcome of
 * people, and of each outcome for each note of subject `none`. Unreadable frames are left out.
 * Free *chosen with free(). -ENOMEM. */
int sim_choose_frames(const struct sim_corpus *corpus, const struct sim_measurement *measurement,
                      size_t n_worst, struct sim_chosen_frame **chosen, size_t *n_chosen)
    __attribute__((warn_unused_result));

/* Draws the chosen frames into DIRECTORY as worst-01-RECORDING-FRAME.png and
 * first-OUTCOME-KIND-RECORDING-FRAME.png. KIND is `person`, the note, or `none` if the note of a
 * non-face is empty. Characters other than letters, digits, '.', '-' and '_' become '_'. The
 * extractor runs again on these frames. Errors of extraction, of reading and of drawing. */
int sim_study_pictures(const struct sim_study *study, const char *directory, size_t n_worst,
                       struct iso_fault *fault) __attribute__((warn_unused_result));

#endif
