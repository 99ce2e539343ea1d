/* How large a face is, compared with the people that the head model was trained on.
 *
 * The fitted head follows a face that is too small or too large as far as its modes allow, so that
 * a part of the size is hidden in its identity. The mean face is therefore registered with a free
 * scale, point to plane with projective association as in pose_fit.h, over seven unknowns (rigid
 * motion and the logarithm of the scale). Then the leading modes of identity become free as well,
 * held by their prior. These modes describe the sizes of people, and which shapes belong to them: a
 * large person has the features of large people, but a large print has those of the person it
 * shows. The remaining scale is what the shapes of people do not explain.
 *
 * Hair is not part of the size. If a vertex above the eyebrows has a surface in front of it, this
 * surface is taken for hair, and the vertex is covered; all other vertices are bare. Covered
 * vertices have no weight in the steps in which the modes are free, and they do not count in the
 * cost of the result. A surface below the eyebrows is never taken for hair, and neither is a
 * surface behind the head. A mask of a wrong size is therefore still noticed: its surface lies in
 * front of the head at some places and behind it at others. */
#ifndef ISO_CORE_PRESENTATION_SIZE_H
#define ISO_CORE_PRESENTATION_SIZE_H

#include "isotherm/frame.h"
#include "isotherm/head_model.h"

struct iso_size {
    double scale;    /* size of the measured face over the size of people with its shape */
    double cost_mm2; /* cost of the fit at this scale over bare vertices; see struct iso_pose_fit */
};

struct iso_sizer;

/* Makes a sizer from the vertices that are compared. They are copied, so that the model is not
 * needed afterwards. -EINVAL if the model's rigid region has fewer than 60 vertices, -ENOMEM. */
int iso_sizer_new(const struct iso_head_model *model, struct iso_sizer **out)
    __attribute__((warn_unused_result));

/* Frees it and what it holds. NULL is accepted. */
void iso_sizer_free(struct iso_sizer *sizer);

/* Measures the size of a face in a cleaned frame. `camera_from_face` is the pose of the head model
 * that was fitted to it. Several threads may use one sizer. -ENODATA if too little is measured to
 * determine the scale. */
int iso_size_measure(const struct iso_sizer *sizer, const struct iso_frame *frame,
                     const struct iso_rigid *camera_from_face, struct iso_size *out)
    __attribute__((warn_unused_result));

/* The scale that the fit found, which the prior of the modes holds near 1: the centroid size
 * (Bookstein 1991) of the rigid region of a fitted head over that of the mean head. `vertex_mm` has
 * the model's vertices. */
double iso_size_of_fit(const struct iso_head_model *model, const struct iso_vec3 *vertex_mm);

#endif
