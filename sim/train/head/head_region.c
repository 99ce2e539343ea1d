#include "sim/train/head/head_region.h"

#include <math.h>
#include <string.h>

#include "isotherm/head_model.h"
#include "sim/train/head/head_exposure.h"

/* In the face frame: from the forehead below the hair line to just under the chin. */
static const double face_top_mm = 70.0, face_depth_mm = 85.0, under_chin_mm = 5.0;

/* A vertex that expressions move less than this along its normal moves with the skull. Lids are
 * excluded, because a depth sensor measures them badly. */
static const double rigid_rms_mm = 0.7, lids_mm = 14.0;

enum { CHIN_IBUG = 8, BROWS_IBUG = 17, SUBNASALE_IBUG = 33, EYES_IBUG = 36, EYE_POINTS = 6 };

bool sim_head_in_face(const struct sim_head_surface *surface, uint32_t vertex)
{
    const uint32_t *source = surface->vertices[vertex].source;
    struct iso_vec3 p = surface->mean_mm[vertex];
    const double chin = surface->mean_mm[surface->landmarks[CHIN_IBUG]].y;
    return source[0] < SIM_ICT_NARROW_FACE_END && source[1] < SIM_ICT_NARROW_FACE_END &&
           p.y <= face_top_mm && p.y >= chin - under_chin_mm && p.z >= -face_depth_mm;
}

void sim_head_importance(const struct sim_head_surface *surface, const double *exposure,
                         double *importance)
{
    const double reach_mm = 12.0, at_feature = 8.0, outside = 0.3, hidden = 0.02;
    for (uint32_t i = 0; i < surface->n_vertices; i++) {
        double nearest_mm = INFINITY;
        for (int k = BROWS_IBUG; k < ISO_LANDMARKS_IBUG; k++) {
            struct iso_vec3 landmark = surface->mean_mm[surface->landmarks[k]];
            nearest_mm = fmin(nearest_mm, iso_norm(iso_sub(surface->mean_mm[i], landmark)));
        }
        const double s = nearest_mm / reach_mm;
        importance[i] = (sim_head_in_face(surface, i) ? 1.0 : outside) + at_feature * exp(-s * s);
        importance[i] *= !sim_head_is_exposed(exposure[i]) ? hidden : 1.0;
    }
}

void sim_head_vertex_areas(const struct sim_head_surface *surface, const uint8_t *region,
                           uint8_t wanted, double *area_mm2)
{
    memset(area_mm2, 0, surface->n_vertices * sizeof *area_mm2);
    for (uint32_t t = 0; t < surface->n_triangles; t++) {
        const uint32_t *v = surface->triangles[t];
        struct iso_vec3 a = surface->mean_mm[v[0]];
        struct iso_vec3 normal = iso_cross(iso_sub(surface->mean_mm[v[1]], a),
                                           iso_sub(surface->mean_mm[v[2]], a));
        for (int k = 0; k < 3; k++) {
            area_mm2[v[k]] += region[v[k]] & wanted ? iso_norm(normal) / 6.0 : 0.0;
        }
    }
}

static bool on_lids(const struct sim_head_surface *surface, uint32_t vertex)
{
    for (int eye = 0; eye < 2; eye++) {
        struct iso_vec3 sum = {0.0, 0.0, 0.0};
        for (int k = 0; k < EYE_POINTS; k++) {
            const uint32_t v = surface->landmarks[EYES_IBUG + eye * EYE_POINTS + k];
            sum = iso_add(sum, surface->mean_mm[v]);
        }
        struct iso_vec3 centre = iso_scale(1.0 / EYE_POINTS, sum);
        if (iso_norm(iso_sub(surface->mean_mm[vertex], centre)) < lids_mm) {
            return true;
        }
    }
    return false;
}

void sim_head_regions(const struct sim_head_surface *surface, const double *exposure,
                      const double *expression_rms_mm, uint8_t *region)
{
    const double upper_lip = surface->mean_mm[surface->landmarks[SUBNASALE_IBUG]].y;
    for (uint32_t i = 0; i < surface->n_vertices; i++) {
        region[i] = 0;
        if (!sim_head_in_face(surface, i) || !sim_head_is_exposed(exposure[i])) {
            continue;
        }
        region[i] = ISO_HEAD_FACE;
        if (expression_rms_mm[i] <= rigid_rms_mm && surface->mean_mm[i].y > upper_lip &&
            !on_lids(surface, i)) {
            region[i] |= ISO_HEAD_RIGID;
        }
    }
}
