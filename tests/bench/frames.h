/* The frames of a stored corpus, for benchmarks. */
#ifndef TESTS_BENCH_FRAMES_H
#define TESTS_BENCH_FRAMES_H

#include "core/base/fault.h"
#include "isotherm/frame.h"
#include "sim/corpus/corpus.h"

/* Uses a frame, which is valid until this returns. 0, or an error that ends the reading. */
typedef int bench_frame_function(void *context, const struct iso_frame *frame,
                                 struct iso_fault *fault);

/* Calls `each` with the frames of a row, in their order. Errors of iso_recording_open and
 * iso_recording_read, -ENOMEM, and those of `each`. */
int bench_frames_of_row(const char *directory, const struct sim_corpus_row *row,
                        bench_frame_function *each, void *context, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* The number of frames of all rows together. */
size_t bench_frames_in(const struct sim_corpus *corpus);

#endif
