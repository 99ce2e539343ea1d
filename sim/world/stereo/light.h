/* Brightness of a point of the scene: material, lamp, projected dots, shadow. */
#ifndef SIM_WORLD_STEREO_LIGHT_H
#define SIM_WORLD_STEREO_LIGHT_H

#include <stdint.h>

#include "sim/world/stereo/rig.h"
#include "sim/world/view/view.h"

struct sim_light {
    const struct sim_stereo_rig *rig;
    /* Finished view from the projector: the surface that its light reaches. */
    const struct sim_view *view;
    const float *shade;               /* [view's pixels]: cosine of incidence, smoothed */
    struct iso_rigid view_from_scene; /* from the frame of the points to that of the projector */
    uint64_t key;                     /* of the textures */
};

/* The share of incoming light that a facet sends back at a point. It is the painted albedo
 * (sim_view_paint) or the material's own, times the material's grain: skin with pores and spots,
 * woven cloth, strands of hair. The values are assumed. */
double sim_albedo(const struct sim_facet *facet, struct iso_vec3 point_mm, uint64_t key);

/* Brightness of the projected pattern in a direction (tangents of angles), with dots spread to
 * the given radius. Its mean over all directions is about 1. Each cell of a grid has one dot at
 * a random place; some dots are brighter than others. */
double sim_dots(const struct sim_stereo_rig *rig, double x, double y, double radius);

/* Radiance of a point towards any camera (matt surfaces), in arbitrary units. It falls with the
 * square of the distance to the projector. */
double sim_light_at(const struct sim_light *light, struct iso_vec3 point_mm,
                    const struct sim_facet *facet);

/* Smooths the cosines of a finished view over 7 x 7 pixels of one material, so that the facets
 * of the head model do not look like texture. */
void sim_light_shade(const struct sim_view *view, float *shade);

#endif
