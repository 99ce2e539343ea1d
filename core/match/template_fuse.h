/* One template from several, for galleries that keep one template of each person. */
#ifndef ISO_CORE_MATCH_TEMPLATE_FUSE_H
#define ISO_CORE_MATCH_TEMPLATE_FUSE_H

#include "core/registration/icp.h"
#include "isotherm/template.h"

/* Makes one template from n of the same person (1..64, all of one algorithm and shape). Each is
 * registered to the first by trimmed ICP. Then the points are averaged by their weights, and the
 * upper faces are moved to the first one and averaged. The result is not marked as learned. `out`
 * may not be one of `templates`. `work` is wiped. -EINVAL for another number of templates or for
 * templates that differ in shape or algorithm, -ENODATA if one has too few points in common with
 * the first. */
int iso_template_fuse(struct iso_icp_workspace *work, const struct iso_template *const *templates,
                      int n, struct iso_template *out) __attribute__((warn_unused_result));

#endif
