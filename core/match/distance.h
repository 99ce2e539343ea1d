/* How far apart two templates are once they are registered. */
#ifndef ISO_CORE_MATCH_DISTANCE_H
#define ISO_CORE_MATCH_DISTANCE_H

#include "core/registration/icp.h"
#include "isotherm/template.h"

struct iso_match_options {
    double trim;                      /* share of the points that count, 0.5..1; default 0.8 */
    int icp_iterations;               /* default 10 */
    enum iso_icp_transform transform; /* default rigid */
    bool left_out[ISO_LANDMARKS];     /* isotherms that neither register nor count; default none */
};

/* The default values above. */
struct iso_match_options iso_match_options_default(void);

/* Measures the trimmed distance, mm. The probe's points are registered to the gallery's by trimmed
 * ICP, each isotherm to the same isotherm. The distance is the weighted mean over the `trim` share
 * of points that are closest. -EINVAL if the algorithms or shapes of the templates differ, or if
 * options are out of range (also if every landmark is left out). -ENODATA if fewer than 30 % of the
 * points that are not left out are present in both. -EDOM if an affine system is singular. */
int iso_match_distance(struct iso_icp_workspace *work, const struct iso_template *probe,
                       const struct iso_template *gallery, const struct iso_match_options *options,
                       double *distance_mm) __attribute__((warn_unused_result));

#endif
