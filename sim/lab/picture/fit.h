/* Draws the fit of the head model to a frame. */
#ifndef SIM_LAB_PICTURE_FIT_H
#define SIM_LAB_PICTURE_FIT_H

#include "core/base/fault.h"
#include "isotherm/frame.h"
#include "isotherm/landmark.h"

enum { SIM_FIT_CAPTIONS = 3 };

/* The content of the picture, in the camera frame; the caller owns all of it. */
struct sim_fit_view {
    const struct iso_frame *frame;
    /* The fitted head; n_vertices is 0 if there is none. */
    uint32_t n_vertices, n_triangles;
    const struct iso_vec3 *vertices_mm;    /* [n_vertices] */
    const uint32_t (*triangles)[3];        /* [n_triangles], counter-clockwise from outside */
    const float *residual_mm;              /* [n_vertices], > 0: the head is before the surface */
    const bool *measured;                  /* [n_vertices]: whether the residual is set */
    const struct iso_vec3 *found_mm;       /* [ISO_LANDMARKS], or NULL */
    const struct iso_vec3 *true_mm;        /* [ISO_LANDMARKS], or NULL */
    const bool *true_known;                /* [ISO_LANDMARKS]: whether the true landmark is known */
    const char *caption[SIM_FIT_CAPTIONS]; /* lines below; NULL: none. The first is bold */
};

/* Draws four panels and the caption: the whole frame in grey, with a mark around the part that
 * the other panels show; that part with found and true landmarks; the fitted head over it; its
 * residuals in colours, with a scale. A panel without content displays a note. The lens's
 * distortion is ignored for the head. -ENOMEM, -EIO. */
int sim_picture_fit(const struct sim_fit_view *view, const char *path, struct iso_fault *fault)
    __attribute__((warn_unused_result));

#endif
