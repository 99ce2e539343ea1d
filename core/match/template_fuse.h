/* One template from several: what a gallery that keeps one template a person enrols. */
#ifndef ISO_CORE_MATCH_TEMPLATE_FUSE_H
#define ISO_CORE_MATCH_TEMPLATE_FUSE_H

#include "core/registration/icp.h"
#include "isotherm/template.h"

/* One template from several of the same person (1..64, all of one algorithm and shape): each is
 * registered to the first by trimmed ICP, then points are averaged by weight, and upper faces
 * moved along (the first keeps its place). -EINVAL for
 * none or templates that differ in shape or algorithm, -ENODATA if one has too few points in common
 * with the first to be registered. What was learned leaves no trace in it. `out` may not be one of
 * them. `work` is wiped. */
int iso_template_fuse(struct iso_icp_workspace *work, const struct iso_template *const *templates,
                      int n, struct iso_template *out) __attribute__((warn_unused_result));

#endif
