#include "sim/door/trace.h"

#include <string.h>

#include "drivers/door/door_null.h"

/* ---- the pipeline ---- */

/* If memory runs out, the frame is missing in the picture. */
static void note_frame(struct sim_trace *trace, const struct iso_frame *frame,
                       const struct iso_extraction *extraction)
{
    trace->noted = false;
    if (!trace->on || trace->decided || trace->n_frames == SIM_TRACE_FRAMES) {
        return;
    }
    struct sim_trace_frame *note = &trace->frames[trace->n_frames];
    const size_t n = (size_t)frame->width_px * (size_t)frame->height_px;
    if (iso_frame_new(&frame->camera, frame->width_px, frame->height_px, false, &note->frame)) {
        return;
    }
    note->frame->crop_x_px = frame->crop_x_px;
    note->frame->crop_y_px = frame->crop_y_px;
    note->frame->t_ns = frame->t_ns;
    memcpy(note->frame->depth_mm, frame->depth_mm, n * sizeof *frame->depth_mm);
    note->outcome = extraction->outcome;
    note->fitted = extraction->fitted;
    memcpy(note->landmark_mm, extraction->landmark_mm, sizeof note->landmark_mm);
    memcpy(note->ibug_mm, extraction->ibug_mm, sizeof note->ibug_mm);
    trace->n_frames++;
    trace->noted = true;
}

static int extract(void *self, const struct iso_frame *frame, const char *sensor,
                   struct iso_extraction *out)
{
    struct sim_trace *trace = self;
    const int error = trace->inner.ops->extract(trace->inner.self, frame, sensor, out);
    if (!error) {
        note_frame(trace, frame, out);
    }
    return error;
}

static int search(void *self, const struct iso_candidate_list *among,
                  const struct iso_template *probe, struct iso_search_hit *hits, int capacity,
                  int *n_hits)
{
    struct sim_trace *trace = self;
    const int error = trace->inner.ops->search(trace->inner.self, among, probe, hits, capacity,
                                               n_hits);
    if (!error && trace->noted) {
        struct sim_trace_frame *note = &trace->frames[trace->n_frames - 1];
        note->compared = *n_hits > 0;
        note->person = note->compared ? hits[0].person : 0;
        note->score = note->compared ? hits[0].score : 0.0;
    }
    trace->noted = false;
    return error;
}

static const struct iso_metric *metric(const void *self)
{
    const struct iso_pipeline *inner = &((const struct sim_trace *)self)->inner;
    return inner->ops->metric ? inner->ops->metric(inner->self) : NULL;
}

static uint32_t algorithm(const void *self)
{
    const struct iso_pipeline *inner = &((const struct sim_trace *)self)->inner;
    return inner->ops->algorithm(inner->self);
}

static uint32_t model(const void *self)
{
    const struct iso_pipeline *inner = &((const struct sim_trace *)self)->inner;
    return inner->ops->model(inner->self);
}

static void close_nothing(void *self)
{
    (void)self;
}

struct iso_pipeline sim_trace_pipeline(struct sim_trace *trace, const struct iso_pipeline *inner)
{
    static const struct iso_pipeline_ops ops = {
        .extract = extract,
        .search = search,
        .metric = metric,
        .algorithm = algorithm,
        .model = model,
        .close = close_nothing,
    };
    trace->inner = *inner;
    return (struct iso_pipeline){&ops, trace};
}

/* ---- the visit ---- */

void sim_trace_begin(struct sim_trace *trace, int64_t now_ns)
{
    trace->on = true;
    trace->start_ns = now_ns;
}

void sim_trace_decide(struct sim_trace *trace, int64_t now_ns)
{
    if (trace->on && !trace->decided) {
        trace->decided = true;
        trace->verdict_ns = now_ns;
    }
}

void sim_trace_end(struct sim_trace *trace, struct iso_door_io *door, int64_t now_ns)
{
    size_t n = 0;
    bool active = false;
    trace->on = false;
    trace->end_ns = now_ns;
    (void)!iso_door_null_event_count(door, &n);
    for (size_t i = n > ISO_DOOR_NULL_HISTORY ? n - ISO_DOOR_NULL_HISTORY : 0; i < n; i++) {
        struct iso_door_null_event event;
        if (iso_door_null_event(door, i, &event) || event.output != ISO_DOOR_RELAY ||
            event.active == active || event.t_ns < trace->start_ns ||
            trace->n_switches == SIM_TRACE_SWITCHES) {
            continue;
        }
        active = event.active;
        trace->relay[trace->n_switches].t_ns = event.t_ns;
        trace->relay[trace->n_switches++].active = active;
    }
}

void sim_trace_done(struct sim_trace *trace)
{
    for (int i = 0; i < trace->n_frames; i++) {
        iso_frame_free(trace->frames[i].frame);
    }
    *trace = (struct sim_trace){.on = false};
}
