#include "core/match/distance.h"

#include <errno.h>

#include "core/match/template_points.h"

/* The weights of the landmarks: how much the surface there depends on the person, compared with the
 * expression. The landmarks of the mouth count least, but they are not left out. Measured on
 * generated people with strong expressions (sim/results/radii.md). */
static const float landmark_weight[ISO_LANDMARKS] = {
    [ISO_LM_NASION] = 1.0f,     [ISO_LM_NOSE_TIP] = 1.0f,  [ISO_LM_SUBNASALE] = 0.5f,
    [ISO_LM_ALA_R] = 0.7f,      [ISO_LM_ALA_L] = 0.7f,     [ISO_LM_EYE_IN_R] = 1.0f,
    [ISO_LM_EYE_IN_L] = 1.0f,   [ISO_LM_EYE_OUT_R] = 1.0f, [ISO_LM_EYE_OUT_L] = 1.0f,
    [ISO_LM_LIP_UPPER] = 0.05f, [ISO_LM_MOUTH_R] = 0.05f,  [ISO_LM_MOUTH_L] = 0.05f,
};

struct iso_match_options iso_match_options_default(void)
{
    return (struct iso_match_options){
        .trim = 0.8, .icp_iterations = 10, .transform = ISO_ICP_RIGID};
}

int iso_match_distance(struct iso_icp_workspace *work, const struct iso_template *probe,
                       const struct iso_template *gallery, const struct iso_match_options *options,
                       double *distance_mm)
{
    if (!iso_template_comparable(probe, gallery) || options->trim < 0.5 || options->trim > 1.0) {
        return -EINVAL;
    }
    struct iso_icp_points source = iso_template_points(probe);
    struct iso_icp_points target = iso_template_points(gallery);
    struct iso_icp_options icp = iso_template_icp_options(options->trim, options->icp_iterations);
    icp.transform = options->transform;
    float group_weight[ISO_TEMPLATE_RADII_MAX * ISO_LANDMARKS];
    int groups = 0;
    for (int g = 0; g < source.n_groups; g++) {
        const int landmark = g % ISO_LANDMARKS;
        group_weight[g] = options->left_out[landmark] ? 0.0f : landmark_weight[landmark];
        groups += !options->left_out[landmark];
    }
    if (groups == 0) {
        return -EINVAL;
    }
    icp.group_weight = group_weight;
    struct iso_icp_result result;
    const int error = iso_icp(work, &source, &target, &icp, &result);
    if (error) {
        return error;
    }
    if (10 * result.pairs < 3 * groups * probe->n_points) {
        return -ENODATA;
    }
    *distance_mm = result.distance_mm;
    return 0;
}
