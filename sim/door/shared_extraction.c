#include "sim/door/shared_extraction.h"

#include <string.h>

static size_t plane_bytes(const struct iso_frame *frame)
{
    return (size_t)frame->width_px * (size_t)frame->height_px * sizeof *frame->depth_mm;
}

static bool same_plane(const float *a, const float *b, size_t bytes)
{
    return a && b ? memcmp(a, b, bytes) == 0 : a == b;
}

static bool is_known(const struct iso_frame *known, const struct iso_frame *frame)
{
    return known && known->t_ns == frame->t_ns && known->width_px == frame->width_px &&
           known->height_px == frame->height_px &&
           same_plane(known->depth_mm, frame->depth_mm, plane_bytes(frame)) &&
           same_plane(known->intensity, frame->intensity, plane_bytes(frame));
}

/* Keeps a copy of the frame, and reuses the existing planes if they fit. -ENOMEM. */
static int keep(struct sim_shared_extraction *shared, const struct iso_frame *frame)
{
    struct iso_frame *kept = shared->frame;
    const bool fits = kept && kept->width_px == frame->width_px &&
                      kept->height_px == frame->height_px && !kept->intensity == !frame->intensity;
    if (!fits) {
        const int error = iso_frame_new(&frame->camera, frame->width_px, frame->height_px,
                                        frame->intensity != NULL, &kept);
        if (error) {
            return error;
        }
        iso_frame_free(shared->frame);
        shared->frame = kept;
    }
    kept->t_ns = frame->t_ns;
    memcpy(kept->depth_mm, frame->depth_mm, plane_bytes(frame));
    if (frame->intensity) {
        memcpy(kept->intensity, frame->intensity, plane_bytes(frame));
    }
    return 0;
}

static int extract(void *self, const struct iso_frame *frame, const char *sensor,
                   struct iso_extraction *out)
{
    struct sim_shared_extraction *shared = ((struct sim_shared_pipeline *)self)->shared;
    const struct iso_pipeline *extractor = &shared->extractor;
    if (!is_known(shared->frame, frame)) {
        int error = extractor->ops->extract(extractor->self, frame, sensor, &shared->extraction);
        if (!error) {
            error = keep(shared, frame);
        }
        if (error) {
            sim_shared_extraction_done(shared);
            return error;
        }
    }
    *out = shared->extraction;
    return 0;
}

/* ---- operations of each appliance's own pipeline ---- */

static const struct iso_pipeline *own_of(const void *self)
{
    return &((const struct sim_shared_pipeline *)self)->own;
}

static int search(void *self, const struct iso_candidate_list *among,
                  const struct iso_template *probe, struct iso_search_hit *hits, int capacity,
                  int *n_hits)
{
    const struct iso_pipeline *own = own_of(self);
    return own->ops->search(own->self, among, probe, hits, capacity, n_hits);
}

static const struct iso_metric *metric(const void *self)
{
    return own_of(self)->ops->metric(own_of(self)->self);
}

static uint32_t algorithm(const void *self)
{
    return own_of(self)->ops->algorithm(own_of(self)->self);
}

static uint32_t model(const void *self)
{
    return own_of(self)->ops->model(own_of(self)->self);
}

static void close_nothing(void *self)
{
    (void)self;
}

/* Only the pipeline that extracted the last frame can answer this. */
static enum iso_face_seen seen(const void *self)
{
    const struct iso_pipeline *extractor =
        &((const struct sim_shared_pipeline *)self)->shared->extractor;
    return extractor->ops->seen(extractor->self);
}

static const char *image_check(const void *self)
{
    return own_of(self)->ops->image_check(own_of(self)->self);
}

static const char *image_lacks(const void *self)
{
    return own_of(self)->ops->image_lacks(own_of(self)->self);
}

struct iso_pipeline sim_shared_pipeline_join(struct sim_shared_extraction *shared,
                                             const struct iso_pipeline *own,
                                             struct sim_shared_pipeline *pipeline)
{
    if (!shared->extractor.ops) {
        shared->extractor = *own;
    }
    *pipeline = (struct sim_shared_pipeline){
        .shared = shared,
        .own = *own,
        .ops = {.extract = extract,
                .search = search,
                .metric = own->ops->metric ? metric : NULL,
                .algorithm = algorithm,
                .model = model,
                .close = close_nothing,
                .seen = shared->extractor.ops->seen ? seen : NULL,
                .image_check = own->ops->image_check ? image_check : NULL,
                .image_lacks = own->ops->image_lacks ? image_lacks : NULL},
    };
    return (struct iso_pipeline){&pipeline->ops, pipeline};
}

void sim_shared_extraction_done(struct sim_shared_extraction *shared)
{
    iso_frame_free(shared->frame);
    shared->frame = NULL;
    iso_template_wipe(&shared->extraction.tmpl);
}
