/* A small recording that tests write. Failures fail the running test. */
#ifndef TESTS_SIM_CORPUS_WRITTEN_RECORDING_H
#define TESTS_SIM_CORPUS_WRITTEN_RECORDING_H

#include "drivers/recording/recording.h"
#include "drivers/recording/recording_writer.h"

enum { WRITTEN_WIDTH = 13, WRITTEN_HEIGHT = 8 };

/* A camera with distortion, whose numbers are no round ones. */
struct iso_recording_meta written_meta(void);

/* A frame of that camera; depths are whole counts, with the largest and the smallest among them. */
struct iso_frame *written_frame(bool with_intensity);

/* Begins the recording `r` of the test's directory. */
struct sim_recording_writer *written_create(void **state, const struct iso_recording_meta *meta);

/* Finishes and frees. */
void written_finish(struct sim_recording_writer *writer);

/* Opens it for reading. */
struct iso_recording *written_open(void **state);

#endif
