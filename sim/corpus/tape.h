/* Writes a recording in a separate thread, so that the camera does not wait while a frame is
 * compressed. Up to SIM_TAPE_FRAMES frames are held in memory. */
#ifndef SIM_CORPUS_TAPE_H
#define SIM_CORPUS_TAPE_H

#include "core/base/fault.h"
#include "drivers/recording/recording_writer.h"
#include "isotherm/frame.h"

enum { SIM_TAPE_FRAMES = 32 };

struct sim_tape;

/* A tape for frames of the same shape as the given one. The writer must outlive the tape.
 * -ENOMEM, -EAGAIN. */
int sim_tape_new(struct sim_recording_writer *writer, const struct iso_frame *like,
                 struct sim_tape **out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Copies a frame and waits for room if necessary. -EINVAL for a frame of another shape, or the
 * error of writing an earlier frame (sim_recording_writer_append), after which nothing more is
 * written. */
int sim_tape_put(struct sim_tape *tape, const struct iso_frame *frame, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Waits until all frames are written, then frees the tape. Returns the error of writing, if
 * there was one. NULL is allowed. */
int sim_tape_finish(struct sim_tape *tape, struct iso_fault *fault);

#endif
