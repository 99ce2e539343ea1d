/* Sampling of curves where they meet rays from a landmark, for callers that sample many curves by
 * the same rays. Internal to core/isotherm. */
#ifndef ISO_CORE_ISOTHERM_RAYS_H
#define ISO_CORE_ISOTHERM_RAYS_H

#include "core/base/lanes.h"
#include "isotherm/isotherm_curve.h"

/* The rays are kept in pairs; the last one may be empty. */
enum { ISO__RAY_PAIRS = (ISO_ISOTHERM_POINTS_MAX + ISO_PAIR - 1) / ISO_PAIR };

struct iso__rays {
    int n, pairs;
    iso_pair x[ISO__RAY_PAIRS], y[ISO__RAY_PAIRS]; /* unit directions, seen from the front */
};

/* Sets n rays of even angles: the first one points to +y, the others follow counter-clockwise. More
 * than ISO_ISOTHERM_POINTS_MAX or fewer than four are refused when a curve is sampled. */
void iso__rays_set(struct iso__rays *rays, int n);

/* As iso_isotherm_sample_polar(), by the rays that are set already. -EINVAL as there. */
int iso__isotherm_sample_rays(struct iso_curve curve, struct iso_vec3 landmark_mm,
                              const struct iso__rays *rays, struct iso_isotherm *out)
    __attribute__((warn_unused_result));

#endif
