/* Every frame of every row of a corpus through the extractor. Subjects are not looked at. */
#ifndef SIM_LAB_MATCH_CAPTURE_H
#define SIM_LAB_MATCH_CAPTURE_H

#include <stdbool.h>
#include <stdint.h>

#include "drivers/recording/recording.h"
#include "isotherm/extract.h"
#include "sim/corpus/corpus.h"

struct sim_capture {
    size_t row, frame; /* of the corpus; of the recording */
    bool readable;     /* false: a missing or damaged file, `extraction` says no face */
    struct iso_extraction extraction; /* stage times are processor time of the worker's thread */
    int64_t wall_ns, cpu_ns;          /* of the extractor's whole run */
};

/* The outcome of a frame: a value of enum iso_capture, or SIM_REASON_UNREADABLE. */
enum { SIM_REASON_UNREADABLE = ISO_CAPTURES, SIM_REASONS };

/* A word of isotherm/capture.h, or "unreadable". */
const char *sim_reason_name(int reason);

int sim_capture_reason(const struct sim_capture *capture);

/* Frames of all rows together. Frame i of row r is number (frames of the rows before r) + i. */
size_t sim_corpus_frames(const struct sim_corpus *corpus);

/* Opens DIRECTORY/NAME; errors of iso_path_join and iso_recording_open. */
int sim_recording_open(const char *directory, const char *name, struct iso_recording **out,
                       struct iso_fault *fault) __attribute__((warn_unused_result));

/* Looks at an extractor right after a frame that was usable, while it still holds the face, and at
 * the frame: what other methods than the appliance's need. Called by several threads at once, once
 * for each number. 0 or a negative errno, which ends the whole. */
typedef int sim_capture_inspector(void *context, size_t number,
                                  const struct iso_extractor *extractor,
                                  const struct iso_frame *frame, const struct sim_capture *capture);

struct sim_capture_options {
    const struct iso_head_model *model;
    struct iso_extract_options extract; /* its clock and sensor are set here */
    int threads;                        /* 1..64 */
    sim_capture_inspector *inspect;     /* or NULL */
    void *inspect_context;
};

/* Of which kind the templates are. */
struct sim_capture_origin {
    uint32_t algorithm;
    char sensor[ISO_TEMPLATE_SENSOR_MAX]; /* of the first recording */
};

/* Looks at the capture of a frame, which is wiped afterwards. Called by several threads at once,
 * once for each number. */
typedef void sim_capture_visitor(void *context, size_t number, const struct sim_capture *capture);

/* `directory` is the corpus's. Unreadable frames are complained about on stderr. Errors of
 * iso_extractor_new and _run; a recording that cannot be opened at all is -EBADMSG. Unless it
 * succeeds, some numbers may not have been visited. */
int sim_capture_all(const char *directory, const struct sim_corpus *corpus,
                    const struct sim_capture_options *options, sim_capture_visitor *visit,
                    void *context, struct sim_capture_origin *origin, struct iso_fault *fault)
    __attribute__((warn_unused_result));

#endif
