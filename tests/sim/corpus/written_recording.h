/* A small recording that tests write. A failure fails the running test. */
#ifndef TESTS_SIM_CORPUS_WRITTEN_RECORDING_H
#define TESTS_SIM_CORPUS_WRITTEN_RECORDING_H

#include "drivers/recording/recording.h"
#include "drivers/recording/recording_writer.h"

enum { WRITTEN_WIDTH = 13, WRITTEN_HEIGHT = 8 };

/* Returns the description of a recording from a camera with distortion. No number is round. */
struct iso_recording_meta written_meta(void);

/* A frame of that camera. Its depths are whole counts, and the largest and the smallest count are
 * among them. */
struct iso_frame *written_frame(bool with_intensity);

/* Begins the recording `r` in the directory of the test. */
struct sim_recording_writer *written_create(void **state, const struct iso_recording_meta *meta);

/* Finishes the recording and frees the writer. */
void written_finish(struct sim_recording_writer *writer);

/* Opens the recording for reading. */
struct iso_recording *written_open(void **state);

#endif
