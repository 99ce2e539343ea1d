/* Several appliances see the same frames: the template of each frame is computed once.
 *
 * Each appliance gets a pipeline of its own that searches its own gallery. All of them take the
 * template from one extractor, which looks at a frame when the first appliance asks for it; the
 * others get a copy. The result is the same as with an extractor each, as long as all appliances
 * see the same frames in the same order. One thread. */
#ifndef SIM_DOOR_SHARED_EXTRACTION_H
#define SIM_DOOR_SHARED_EXTRACTION_H

#include "firmware/recognise/pipeline.h"

/* The frame that was looked at last. All zero at first; biometric. */
struct sim_shared_extraction {
    struct iso_pipeline extractor; /* whose extractor is used; borrowed */
    struct iso_frame *frame;       /* a copy; NULL: there was none yet */
    struct iso_extraction extraction;
};

/* One appliance's pipeline. */
struct sim_shared_pipeline {
    struct sim_shared_extraction *shared;
    struct iso_pipeline own;     /* searches and says what it is; borrowed */
    struct iso_pipeline_ops ops; /* has only those OPTIONAL ones that `own` has */
};

/* The pipeline of the next appliance. The first one's extractor is used for all. Everything must
 * outlive the pipeline that is returned; nobody closes it. */
struct iso_pipeline sim_shared_pipeline_join(struct sim_shared_extraction *shared,
                                             const struct iso_pipeline *own,
                                             struct sim_shared_pipeline *pipeline);

/* Forgets the frame. All zero is fine. */
void sim_shared_extraction_done(struct sim_shared_extraction *shared);

#endif
