#include "tests/bench/frames.h"

#include <string.h>

#include "drivers/recording/recording.h"
#include "sim/lab/match/capture.h"

int bench_frames_of_row(const char *directory, const struct sim_corpus_row *row,
                        bench_frame_function *each, void *context, struct iso_fault *fault)
{
    struct iso_recording *recording = NULL;
    struct iso_frame *frame = NULL;
    int error = sim_recording_open(directory, row->recording, &recording, fault);
    if (error) {
        return error;
    }
    error = iso_recording_frame_new(recording, &frame);
    if (error) {
        (void)iso_fault_set(fault, error, "%s: %s", row->recording, strerror(-error));
    }
    for (size_t i = 0; !error && i < row->count; i++) {
        error = iso_recording_read(recording, row->first + i, frame, fault);
        if (!error) {
            error = each(context, frame, fault);
        }
    }
    iso_frame_free(frame);
    iso_recording_close(recording);
    return error;
}

size_t bench_frames_in(const struct sim_corpus *corpus)
{
    size_t n = 0;
    for (size_t i = 0; i < corpus->n_rows; i++) {
        n += corpus->rows[i].count;
    }
    return n;
}
