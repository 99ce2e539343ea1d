/* How bright a point of the scene is: material, lamp, projected dots, shadow. */
#ifndef SIM_WORLD_STEREO_LIGHT_H
#define SIM_WORLD_STEREO_LIGHT_H

#include <stdint.h>

#include "sim/world/stereo/rig.h"
#include "sim/world/view/view.h"

struct sim_light {
    const struct sim_stereo_rig *rig;
    const struct sim_view *view;      /* from the projector, finished: what it can reach */
    const float *shade;               /* [view's pixels]: cosine of incidence, smoothed */
    struct iso_rigid view_from_scene; /* the projector's frame from that of the points asked for */
    uint64_t key;                     /* of the textures */
};

/* What share of incoming light a facet sends back at a point: as it is painted (sim_view_paint), or
 * as its material is, times the material's grain: skin with its pores and spots, woven cloth,
 * strands of hair. Assumed values. */
double sim_albedo(const struct sim_facet *facet, struct iso_vec3 point_mm, uint64_t key);

/* Brightness of the projected pattern in a direction (tangents of angles), dots spread to the given
 * radius; its mean over all directions is about 1. Dots stand one to a cell of a grid, anywhere in
 * it, some brighter than others. */
double sim_dots(const struct sim_stereo_rig *rig, double x, double y, double radius);

/* Radiance of a point towards any camera (matt surfaces), in arbitrary units that fall with the
 * square of the distance to the projector. */
double sim_light_at(const struct sim_light *light, struct iso_vec3 point_mm,
                    const struct sim_facet *facet);

/* Smooths the cosines of a finished view over 7 x 7 pixels of one material, so that the head
 * model's facets are not seen as texture. */
void sim_light_shade(const struct sim_view *view, float *shade);

#endif
