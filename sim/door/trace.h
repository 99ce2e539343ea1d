/* The result of each frame of one visit, for a picture of the visit. A wrapper pipeline passes
 * extraction, search, metric, algorithm and model on to the appliance's own pipeline and records
 * the results. It has none of the other OPTIONAL operations. */
#ifndef SIM_DOOR_TRACE_H
#define SIM_DOOR_TRACE_H

#include <stdbool.h>
#include <stdint.h>

#include "drivers/door/door_io.h"
#include "firmware/recognise/pipeline.h"

enum { SIM_TRACE_FRAMES = 8, SIM_TRACE_SWITCHES = 32 };

struct sim_trace_frame {
    struct iso_frame *frame; /* a copy */
    enum iso_capture outcome;
    bool fitted; /* the next two fields are set */
    struct iso_vec3 landmark_mm[ISO_LANDMARKS];
    struct iso_vec3 ibug_mm[ISO_LANDMARKS_IBUG];
    bool compared;  /* the next two fields are set */
    int64_t person; /* the best candidate of the gallery; 0: none */
    double score;
};

struct sim_trace {
    bool on;            /* frames are being recorded */
    bool decided;       /* a verdict was given; later frames do not count */
    int64_t start_ns;   /* when recording began */
    int64_t verdict_ns; /* when the verdict was given */
    int64_t end_ns;     /* when recording ended */
    bool noted;         /* the last extracted frame was kept and waits for its search */
    int n_frames;       /* at most SIM_TRACE_FRAMES are kept */
    struct sim_trace_frame frames[SIM_TRACE_FRAMES];
    int n_switches;
    struct {
        int64_t t_ns;
        bool active;
    } relay[SIM_TRACE_SWITCHES]; /* each change after the start */
    struct iso_pipeline inner;
};

/* A pipeline that records the results of `inner` in the trace. Both must outlive it. It is never
 * closed. */
struct iso_pipeline sim_trace_pipeline(struct sim_trace *trace, const struct iso_pipeline *inner);

/* Starts to record frames. A trace records one visit. */
void sim_trace_begin(struct sim_trace *trace, int64_t now_ns);

/* Records the time of the first verdict. Later frames are not recorded. */
void sim_trace_decide(struct sim_trace *trace, int64_t now_ns);

/* Stops recording, and adds the relay's changes since the start, read from a door of the back end
 * `null`. */
void sim_trace_end(struct sim_trace *trace, struct iso_door_io *door, int64_t now_ns);

/* Frees the frames. An all-zero trace is allowed. */
void sim_trace_done(struct sim_trace *trace);

#endif
