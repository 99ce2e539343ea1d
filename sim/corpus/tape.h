/* Writes a recording in a thread of its own, so that the camera need not wait while a frame is
 * compressed. Up to SIM_TAPE_FRAMES frames are held until then. */
#ifndef SIM_CORPUS_TAPE_H
#define SIM_CORPUS_TAPE_H

#include "core/base/fault.h"
#include "drivers/recording/recording_writer.h"
#include "isotherm/frame.h"

enum { SIM_TAPE_FRAMES = 32 };

struct sim_tape;

/* A tape for frames of this one's shape into the writer, which must outlive it. -ENOMEM, -EAGAIN.
 */
int sim_tape_new(struct sim_recording_writer *writer, const struct iso_frame *like,
                 struct sim_tape **out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Copies a frame; waits for room if necessary. -EINVAL for a frame of another shape, or the error
 * of writing an earlier one (sim_recording_writer_append): nothing is written from then on. */
int sim_tape_put(struct sim_tape *tape, const struct iso_frame *frame, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Waits until all is written, and frees. Returns the error of writing, if there was one. NULL is
 * fine. */
int sim_tape_finish(struct sim_tape *tape, struct iso_fault *fault);

#endif
