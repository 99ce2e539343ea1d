/* A template seen as the curves that ICP registers. Internal to core/match. */
#ifndef ISO_CORE_MATCH_TEMPLATE_POINTS_H
#define ISO_CORE_MATCH_TEMPLATE_POINTS_H

#include <stdbool.h>
#include <stddef.h>

#include "core/registration/icp.h"
#include "isotherm/template.h"

/* The points of a template: one group of ISO_TEMPLATE_POINTS_MAX points for each radius and
 * landmark, in the memory of the template. Points beyond n_points have weight 0, so that they do
 * not count. */
static inline struct iso_icp_points iso_template_points(const struct iso_template *t)
{
    return (struct iso_icp_points){
        .n_groups = t->n_radii * ISO_LANDMARKS,
        .n_per_group = ISO_TEMPLATE_POINTS_MAX,
        .point_mm = t->points_mm[0][0],
        .weight = t->weight[0][0],
    };
}

/* Whether two templates have the same algorithm and shape. */
static inline bool iso_template_comparable(const struct iso_template *a,
                                           const struct iso_template *b)
{
    return a->algorithm == b->algorithm && a->n_radii == b->n_radii && a->n_points == b->n_points;
}

/* Options for the registration of templates: rigid, each point to the point of the same number. */
static inline struct iso_icp_options iso_template_icp_options(double trim, int iterations)
{
    return (struct iso_icp_options){
        .transform = ISO_ICP_RIGID,
        .pairing = ISO_ICP_ORDERED,
        .trim = trim,
        .iterations_max = iterations,
        .tolerance_mm = 1e-4,
    };
}

#endif
