/* The picture of a fit of the head model to a frame. */
#ifndef SIM_LAB_PICTURE_FIT_H
#define SIM_LAB_PICTURE_FIT_H

#include "core/base/fault.h"
#include "isotherm/frame.h"
#include "isotherm/landmark.h"

enum { SIM_FIT_CAPTIONS = 3 };

/* What there is to be drawn; camera frame, all belongs to the caller. */
struct sim_fit_view {
    const struct iso_frame *frame;
    /* The fitted head; n_vertices 0: there is none. */
    uint32_t n_vertices, n_triangles;
    const struct iso_vec3 *vertices_mm;    /* [n_vertices] */
    const uint32_t (*triangles)[3];        /* [n_triangles], counter-clockwise from outside */
    const float *residual_mm;              /* [n_vertices], > 0: the head is before the surface */
    const bool *measured;                  /* [n_vertices]: whether the residual says anything */
    const struct iso_vec3 *found_mm;       /* [ISO_LANDMARKS], or NULL */
    const struct iso_vec3 *true_mm;        /* [ISO_LANDMARKS], or NULL */
    const bool *true_known;                /* [ISO_LANDMARKS]: which of the true ones there are */
    const char *caption[SIM_FIT_CAPTIONS]; /* lines below; NULL: none. The first is bold */
};

/* Draws four panels and the caption: the whole frame, grey, with the part that the others show;
 * that part with landmarks found and true; the fitted head over it; its residuals in colours, with
 * a scale. A panel that has nothing to show says so. Distortion of the lens is ignored for the
 * head. -ENOMEM, -EIO. */
int sim_picture_fit(const struct sim_fit_view *view, const char *path, struct iso_fault *fault)
    __attribute__((warn_unused_result));

#endif
