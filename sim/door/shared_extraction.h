/* Computes the template of each frame once for several appliances that see the same frames.
 *
 * Each appliance gets its own pipeline, which searches its own gallery. All of them take the
 * template from one extractor, which runs when the first appliance asks for the frame; the
 * others get a copy. The result is the same as with one extractor for each appliance, provided
 * that all appliances see the same frames in the same order. One thread. */
#ifndef SIM_DOOR_SHARED_EXTRACTION_H
#define SIM_DOOR_SHARED_EXTRACTION_H

#include "firmware/recognise/pipeline.h"

/* The frame that was extracted last, and its result. All zero at first. Holds biometric data. */
struct sim_shared_extraction {
    struct iso_pipeline extractor; /* the pipeline whose extractor is used; borrowed */
    struct iso_frame *frame;       /* a copy; NULL before the first frame */
    struct iso_extraction extraction;
};

/* One appliance's pipeline. */
struct sim_shared_pipeline {
    struct sim_shared_extraction *shared;
    struct iso_pipeline own;     /* does everything except the extraction; borrowed */
    struct iso_pipeline_ops ops; /* has an OPTIONAL operation only if `own` has it; `seen` only if
                                    the shared extractor has it */
};

/* The pipeline of the next appliance. All appliances use the first one's extractor. All
 * arguments must outlive the returned pipeline, which is not closed. */
struct iso_pipeline sim_shared_pipeline_join(struct sim_shared_extraction *shared,
                                             const struct iso_pipeline *own,
                                             struct sim_shared_pipeline *pipeline);

/* Frees the frame and wipes its template. An all-zero struct is allowed. */
void sim_shared_extraction_done(struct sim_shared_extraction *shared);

#endif
