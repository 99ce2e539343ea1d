/* The result of each frame of one visit, for a picture of the visit. A pipeline that passes every
 * call on to the appliance's own pipeline notes the results. */
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
    bool fitted; /* the two below mean something */
    struct iso_vec3 landmark_mm[ISO_LANDMARKS];
    struct iso_vec3 ibug_mm[ISO_LANDMARKS_IBUG];
    bool compared;  /* the two below mean something */
    int64_t person; /* of the gallery: the best one; 0: nobody */
    double score;
};

struct sim_trace {
    bool on;            /* frames are noted while it is */
    bool decided;       /* frames that come later do not count */
    int64_t start_ns;   /* since when */
    int64_t verdict_ns; /* once it is decided */
    int64_t end_ns;     /* until when the door was watched */
    int n_frames;       /* those after SIM_TRACE_FRAMES are not kept */
    struct sim_trace_frame frames[SIM_TRACE_FRAMES];
    int n_switches;
    struct {
        int64_t t_ns;
        bool active;
    } relay[SIM_TRACE_SWITCHES]; /* each change since the start */
    struct iso_pipeline inner;
};

/* A pipeline that notes into the trace what `inner` does. Both must outlive it; nobody closes it.
 */
struct iso_pipeline sim_trace_pipeline(struct sim_trace *trace, const struct iso_pipeline *inner);

/* From now on frames are noted. */
void sim_trace_begin(struct sim_trace *trace, int64_t now_ns);

/* There is a verdict. */
void sim_trace_decide(struct sim_trace *trace, int64_t now_ns);

/* Stops noting, and adds what the relay of a door of the back end `null` did since the start. */
void sim_trace_end(struct sim_trace *trace, struct iso_door_io *door, int64_t now_ns);

void sim_trace_done(struct sim_trace *trace);

#endif
