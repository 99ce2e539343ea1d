/* Runs the extractor on every frame of every row of a corpus. Subjects are not used here. */
#ifndef SIM_LAB_MATCH_CAPTURE_H
#define SIM_LAB_MATCH_CAPTURE_H

#include <stdbool.h>
#include <stdint.h>

#include "drivers/recording/recording.h"
#include "isotherm/extract.h"
#include "sim/corpus/corpus.h"

struct sim_capture {
    size_t row, frame; /* row of the corpus; frame of the recording */
    bool readable;     /* false: a missing or damaged file; `extraction` then reports no face */
    struct iso_extraction extraction; /* stage times: processor time of the worker's thread */
    int64_t wall_ns, cpu_ns;          /* duration of the extractor's whole run */
};

/* The outcome of a frame: a value of enum iso_capture, or SIM_REASON_UNREADABLE. */
enum { SIM_REASON_UNREADABLE = ISO_CAPTURES, SIM_REASONS };

/* A word of isotherm/capture.h, or "unreadable". */
const char *sim_reason_name(int reason);

/* The outcome of a capture. */
int sim_capture_reason(const struct sim_capture *capture);

/* The number of frames of all rows. Frame i of row r has number (frames of the rows before r) + i.
 */
size_t sim_corpus_frames(const struct sim_corpus *corpus);

/* Opens DIRECTORY/NAME; errors of iso_path_join and iso_recording_open. */
int sim_recording_open(const char *directory, const char *name, struct iso_recording **out,
                       struct iso_fault *fault) __attribute__((warn_unused_result));

/* Called after a usable frame, while the extractor still holds the face, to take data for
 * methods other than the appliance's. Several threads call it at the same time, once for each
 * number. Returns 0 or a negative errno, which ends the whole run. */
typedef int sim_capture_inspector(void *context, size_t number,
                                  const struct iso_extractor *extractor,
                                  const struct iso_frame *frame, const struct sim_capture *capture);

struct sim_capture_options {
    const struct iso_head_model *model;
    struct iso_extract_options extract; /* sim_capture_all sets its clock and sensor */
    int threads;                        /* 1..64 */
    sim_capture_inspector *inspect;     /* or NULL */
    void *inspect_context;
};

/* The algorithm of the templates, and their kind of sensor. */
struct sim_capture_origin {
    uint32_t algorithm;
    char sensor[ISO_TEMPLATE_SENSOR_MAX]; /* of the first recording */
};

/* Called with the capture of a frame, which is wiped afterwards. Several threads call it at the
 * same time, once for each number. */
typedef void sim_capture_visitor(void *context, size_t number, const struct sim_capture *capture);

/* Runs the extractor on all frames of the corpus in `directory` and calls the visitor for each.
 * Unreadable frames are reported on stderr. Errors of sim_recording_open, iso_extractor_new,
 * iso_extractor_run and the inspector; -ENOMEM; each with a fault. On failure the visitor may not
 * have been called for some numbers. */
int sim_capture_all(const char *directory, const struct sim_corpus *corpus,
                    const struct sim_capture_options *options, sim_capture_visitor *visit,
                    void *context, struct sim_capture_origin *origin, struct iso_fault *fault)
    __attribute__((warn_unused_result));

#endif
