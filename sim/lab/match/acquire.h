/* From the frames of a corpus to templates.
 *
 * Every frame of every row goes through the extractor. The frames of a row are divided into
 * groups (fusing): each group is one sample, and its usable frames make one template. A sample
 * without a usable frame is a failure to acquire, with the reason of its first frame. Subjects
 * are not used here. */
#ifndef SIM_LAB_MATCH_ACQUIRE_H
#define SIM_LAB_MATCH_ACQUIRE_H

#include "sim/lab/match/capture.h"

enum { SIM_SAMPLE_CAPTURES_MAX = 64 }; /* the limit of iso_template_fuse */

struct sim_sample {
    size_t row;
    size_t first_capture, n_captures;
    bool acquired;
    int reason; /* as sim_capture_reason; ISO_CAPTURE_OK if acquired */
    struct iso_template tmpl;
};

struct sim_acquisition {
    size_t n_captures, n_samples;
    struct sim_capture *captures; /* in order of rows, then frames */
    struct sim_sample *samples;
    struct sim_capture_origin origin;
};

/* Runs the extractor on all frames and makes the samples. `fuse`: frames in a sample; 0: all frames
 * of the row. A sample never has more than SIM_SAMPLE_CAPTURES_MAX frames. Errors of
 * sim_capture_all and iso_template_fuse; -ENOMEM; each with a fault. */
int sim_acquire(const char *directory, const struct sim_corpus *corpus,
                const struct sim_capture_options *options, size_t fuse,
                struct sim_acquisition **out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Wipes and frees it and what it holds. NULL is accepted. */
void sim_acquisition_free(struct sim_acquisition *acquisition);

#endif
