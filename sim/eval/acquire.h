/* From the frames of a corpus to templates.
 *
 * Every frame of every row goes through the extractor. The frames of a row are taken in groups
 * (fusing): each group is one sample, whose usable frames make one template. A sample without a
 * usable frame is a failure to acquire, with the reason of its first frame. Subjects are not looked
 * at. */
#ifndef SIM_EVAL_ACQUIRE_H
#define SIM_EVAL_ACQUIRE_H

#include <stdbool.h>
#include <stdint.h>

#include "core/extract.h"
#include "sim/recording/corpus.h"

struct sim_capture {
    size_t row, frame; /* of the corpus; of the recording */
    bool readable;     /* false: a missing or damaged file, `extraction` says no face */
    struct iso_extraction extraction; /* stage times are processor time of the worker's thread */
    int64_t wall_ns, cpu_ns;          /* of the extractor's whole run */
};

/* Why a sample was not acquired: a value of enum iso_capture, or SIM_REASON_UNREADABLE. */
enum { SIM_REASON_UNREADABLE = ISO_CAPTURES, SIM_REASONS };

/* A word of core/capture.h, or "unreadable". */
const char *sim_reason_name(int reason);

struct sim_sample {
    size_t row;
    size_t first_capture, n_captures;
    bool acquired;
    int reason; /* ISO_CAPTURE_OK if acquired */
    struct iso_template tmpl;
};

struct sim_acquisition {
    size_t n_captures, n_samples;
    struct sim_capture *captures; /* in order of rows, then frames */
    struct sim_sample *samples;
    uint32_t algorithm;                   /* of the templates */
    char sensor[ISO_TEMPLATE_SENSOR_MAX]; /* of the first recording */
};

struct sim_acquire_options {
    const struct iso_head_model *model;
    struct iso_extract_options extract; /* its clock and sensor are set here */
    size_t fuse;                        /* frames in a sample; 0: all frames of the row */
    int threads;
};

/* `directory` is the corpus's. Unreadable frames are complained about on stderr. Errors of
 * iso_extractor_new and _run; a recording that cannot be opened at all is -EBADMSG. */
int sim_acquire(const char *directory, const struct sim_corpus *corpus,
                const struct sim_acquire_options *options, struct sim_acquisition **out,
                struct iso_fault *fault) __attribute__((warn_unused_result));
void sim_acquisition_free(struct sim_acquisition *acquisition);

#endif
