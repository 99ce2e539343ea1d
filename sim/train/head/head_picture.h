/* Draws pictures of a head model, to find holes and spikes by eye. */
#ifndef SIM_TRAIN_HEAD_HEAD_PICTURE_H
#define SIM_TRAIN_HEAD_HEAD_PICTURE_H

#include "core/base/fault.h"
#include "isotherm/head_model.h"

/* Writes PNG files into an existing directory: mean.png, mesh.png (with the triangles' edges)
 * and, for the first five identity and expression modes, identity-N-minus.png and so on, two
 * standard deviations to either side. Each shows the head from the front and turned by 50
 * degrees. -ENOMEM, or errors of writing with *fault. */
int sim_head_pictures(const struct iso_head_model *model, const char *directory,
                      struct iso_fault *fault) __attribute__((warn_unused_result));

#endif
