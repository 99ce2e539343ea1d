/* The head model fitted to a depth frame: pose, identity and expression together.
 *
 * Robust Gauss-Newton on point-to-plane residuals with projective association, as in pose_fit.h,
 * over six degrees of freedom and the coefficients of the model's modes, which are held by their
 * prior N(0, 1) (regularised morphable model fit: Blanz and Vetter 1999; Amberg, Knothe and Vetter
 * 2008). The first steps are rigid. Then all modes are fitted from several openings of the jaw, and
 * the best of these fits is continued. With nine or ten iterations a start that lags far behind a
 * good one is given up early; how far was measured with ten. The fit serves to find the landmarks:
 * those of the fitted head are repeatable to a fraction of the noise, because they depend on the
 * whole face. */
#ifndef ISO_CORE_LANDMARK_SHAPE_FIT_H
#define ISO_CORE_LANDMARK_SHAPE_FIT_H

#include "core/landmark/meeting.h"
#include "core/landmark/pose_fit.h"
#include "isotherm/head_fit.h"

struct iso_shape_fit {
    struct iso_pose_fit pose;
    float identity[ISO_HEAD_IDENTITY_MAX]; /* in standard deviations of the training set */
    float expression[ISO_HEAD_EXPRESSION_MAX];
    double identity_norm;                        /* root mean square of the coefficients */
    double expression_norm;                      /* the strength of the expression; 0: none */
    struct iso_vec3 ibug_mm[ISO_LANDMARKS_IBUG]; /* of the fitted head, face frame */
    /* The twelve landmarks of the head without its expression, face frame: where they would be if
     * the face were at rest. */
    struct iso_vec3 neutral_mm[ISO_LANDMARKS];
    /* Standard deviation of the position of each of the twelve (root of the trace of its
     * covariance), from the curvature of the fit at its minimum and its residual. */
    double sigma_mm[ISO_LANDMARKS];
};

/* The fitted head compared with the frame, vertex by vertex. The arrays belong to the fitter and
 * are valid until its next fit. */
struct iso_shape_residuals {
    uint32_t n;                       /* the model's vertices */
    const struct iso_vec3 *vertex_mm; /* [n] the fitted head, face frame */
    const float *residual_mm; /* [n] along the normal, > 0: the head is before the surface */
    const uint8_t *meeting;   /* [n] enum iso_meeting; turned away if a vertex is not compared */
};

struct iso_shape_fitter;

/* Makes a fitter. The model must outlive it. -EINVAL for options out of range or fewer than 100
 * vertices to compare, -ENOMEM. */
int iso_shape_fitter_new(const struct iso_head_model *model,
                         const struct iso_shape_fit_options *options, struct iso_shape_fitter **out)
    __attribute__((warn_unused_result));

/* Wipes the shape of the last face and frees the fitter. NULL is accepted. */
void iso_shape_fitter_free(struct iso_shape_fitter *fitter);

/* Fits the head model to a frame, beginning at a pose of the mean face. -ENODATA if too little of
 * the face is measured to determine the fit. */
int iso_shape_fit(struct iso_shape_fitter *fitter, const struct iso_frame *frame,
                  const struct iso_rigid *start, struct iso_shape_fit *out)
    __attribute__((warn_unused_result));

/* As iso_shape_fit(), but only the pose of the head and how well it fits, without landmarks and
 * residuals. iso_shape_fitter_residuals() has no meaning until the next iso_shape_fit(). */
int iso_shape_fit_pose(struct iso_shape_fitter *fitter, const struct iso_frame *frame,
                       const struct iso_rigid *start, struct iso_pose_fit *out)
    __attribute__((warn_unused_result));

/* The residuals of the last iso_shape_fit() that succeeded. */
struct iso_shape_residuals iso_shape_fitter_residuals(const struct iso_shape_fitter *fitter);

#endif
