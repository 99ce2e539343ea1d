/* Writes recordings in the format that drivers/recording/recording.h reads. The writer refuses
 * everything that the reader would refuse, so that each recording can be read back. The same frames
 * always make the same bytes. Every failure is one line in *fault (which may be NULL). */
#ifndef SIM_RECORDING_RECORDING_WRITER_H
#define SIM_RECORDING_RECORDING_WRITER_H

#include <stddef.h>

#include "core/base/fault.h"
#include "drivers/recording/recording.h"
#include "isotherm/frame.h"

struct sim_recording_writer;

/* The camera to put into a recording's meta for frames like this one: it has the size of the
 * frame's planes, and its principal point is moved by the frame's crop. */
struct iso_camera sim_recording_camera(const struct iso_frame *frame);

/* Makes the directory (its parent must exist; a directory that exists must be empty) and prepares
 * to write into it. The meta is copied. `png_level` is zlib's 1 (fast) to 9 (small). -EINVAL for a
 * meta that no reader would accept or a png_level out of range, -EEXIST if the directory holds
 * something, -ENOMEM, or the errno of mkdir and open. */
int sim_recording_writer_create(const char *directory, const struct iso_recording_meta *meta,
                                int png_level, struct sim_recording_writer **out,
                                struct iso_fault *fault) __attribute__((warn_unused_result));

/* Appends one frame: depths rounded to counts of unit_mm, time stamp frame->t_ns (>= 0, after the
 * frame before), intensity as 16-bit ir/ if the frame has one (all frames or none, 0..1). The frame
 * must be of the meta's camera (sim_recording_camera(frame) equals it). -EINVAL for a frame that
 * does not fit, -ERANGE for a depth that a 16-bit count cannot hold or that would round to 0,
 * -ENOMEM, or the errno of writing. */
int sim_recording_writer_append(struct sim_recording_writer *writer, const struct iso_frame *frame,
                                struct iso_fault *fault) __attribute__((warn_unused_result));

/* Adds a ground-truth point of the frame that was appended last, rounded to 0.0001 mm. -EINVAL if
 * the name is empty, too long or not of [A-Za-z0-9_-], if the point is not finite, or if no frame
 * was appended yet; or the errno of writing. */
int sim_recording_writer_landmark(struct sim_recording_writer *writer, const char *name,
                                  struct iso_vec3 point_mm, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Writes the remaining buffers and closes the files. -ENODATA if no frame was appended, or the
 * errno of writing. The writer still has to be freed. */
int sim_recording_writer_finish(struct sim_recording_writer *writer, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Frees the writer. If it was not finished, its files remain as they are. NULL is fine. */
void sim_recording_writer_free(struct sim_recording_writer *writer);

#endif
