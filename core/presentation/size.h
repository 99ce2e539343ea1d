/* How large the fitted head is beside the people that the head model was trained on. */
#ifndef ISO_CORE_PRESENTATION_SIZE_H
#define ISO_CORE_PRESENTATION_SIZE_H

#include "core/landmark/shape_fit.h"

struct iso_size {
    double scale;    /* centroid size of the fitted face over that of the mean face */
    double residual; /* what the measurement would still change it by, as a share */
};

int iso_size_measure(const struct iso_head_model *model, const struct iso_shape_residuals *head,
                     struct iso_size *out) __attribute__((warn_unused_result));

#endif
