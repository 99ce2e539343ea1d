#include "core/match/distance.h"

#include <errno.h>

#include "core/match/template_points.h"

struct iso_match_options iso_match_options_default(void)
{
    return (struct iso_match_options){
        .trim = 0.8, .icp_iterations = 10, .transform = ISO_ICP_RIGID};
}

int iso_match_distance(const struct iso_template *probe, const struct iso_template *gallery,
                       const struct iso_match_options *options, double *distance_mm)
{
    if (!iso_template_comparable(probe, gallery) || options->trim < 0.5 || options->trim > 1.0) {
        return -EINVAL;
    }
    struct iso_icp_points source = iso_template_points(probe);
    struct iso_icp_points target = iso_template_points(gallery);
    struct iso_icp_options icp = iso_template_icp_options(options->trim, options->icp_iterations);
    icp.transform = options->transform;
    struct iso_icp_result result;
    int error = iso_icp(&source, &target, &icp, &result);
    if (error) {
        return error;
    }
    if (10 * result.pairs < 3 * probe->n_radii * ISO_LANDMARKS * probe->n_points) {
        return -ENODATA;
    }
    *distance_mm = result.distance_mm;
    return 0;
}
