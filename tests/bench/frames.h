/* The frames of a stored corpus, for what is measured on them. */
#ifndef TESTS_BENCH_FRAMES_H
#define TESTS_BENCH_FRAMES_H

#include "core/base/fault.h"
#include "isotherm/frame.h"
#include "sim/corpus/corpus.h"

/* Does something with a frame, which is there until it returns. 0, or what ends all. */
typedef int bench_frame_function(void *context, const struct iso_frame *frame,
                                 struct iso_fault *fault);

/* Hands the frames of a row to `each`, in their order. Errors of iso_recording_open and
 * iso_recording_read, -ENOMEM, and those of `each`. */
int bench_frames_of_row(const char *directory, const struct sim_corpus_row *row,
                        bench_frame_function *each, void *context, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* How many frames the rows have, all together. */
size_t bench_frames_in(const struct sim_corpus *corpus);

#endif
