/* The true view of a scene: the surface that an ideal sensor would see at each pixel.
 *
 * A view is cleared and solids are drawn into it in camera-frame coordinates, where the nearest
 * wins. Then it is finished, and sensor models (sim/world/sensor) read it. A view is created
 * once and reused for every frame. */
#ifndef SIM_WORLD_VIEW_VIEW_H
#define SIM_WORLD_VIEW_VIEW_H

#include <stddef.h>
#include <stdint.h>

#include "isotherm/camera.h"

enum sim_material {
    SIM_NOTHING = 0,
    SIM_SKIN,
    SIM_HAIR,
    SIM_CLOTH,
    SIM_WALL,
    SIM_PAPER,
    SIM_PLASTIC,
    SIM_GLASS,  /* of a display: little light scatters back, and from slightly behind the surface */
    SIM_MIRROR, /* hides the scene behind it, but returns none of the emitter's light */
};

/* The smallest drawn depth. */
#define SIM_VIEW_NEAR_MM 50.0

struct sim_facet {
    struct iso_vec3 normal; /* unit, either sign */
    enum sim_material material;
    float albedo; /* in the infrared image; 0: the material's own */
};

enum { SIM_VIEW_COMPANIONS_MAX = 3 };

struct sim_view;

/* Another eye on the same scene, such as the second camera of a stereo pair. All solids drawn
 * into a view are also drawn into its companions, which are cleared and finished with it. */
struct sim_companion {
    struct sim_view *view; /* borrowed; outlives the view that refers to it */
    struct iso_rigid companion_from_view;
};

struct sim_view {
    /* Of the view, with `supersample` times the sensor's pixels along each axis. */
    struct iso_camera camera;
    int supersample;   /* view pixels per sensor pixel, along each axis */
    float *depth_mm;   /* [height_px * width_px]; 0: no surface */
    float *cosine;     /* between the surface's normal and the line of sight, 0..1 */
    uint8_t *material; /* enum sim_material */
    int32_t *facet;    /* the visible facet: index into facets, or -1 */
    struct sim_facet *facets;
    int32_t n_facets, facet_capacity;
    struct sim_companion companions[SIM_VIEW_COMPANIONS_MAX];
    int n_companions;              /* 0 when the view is made */
    struct iso_vec3 *companion_mm; /* scratch: vertices in the companion's frame */
    size_t companion_capacity;
};

/* A cleared view for a sensor's camera, whose distortion must be 0. -EINVAL for an invalid camera
 * or a `supersample` outside 1..4, -ENOMEM. */
int sim_view_new(const struct iso_camera *sensor_camera, int supersample, struct sim_view **out)
    __attribute__((warn_unused_result));

/* Frees it and what it holds. NULL is accepted. */
void sim_view_free(struct sim_view *view);

/* Removes all surfaces from the view and its companions. */
void sim_view_clear(struct sim_view *view);

/* Draws both sides of triangles given by camera-frame vertices. After -ENOMEM the content is
 * undefined until the view is cleared. */
int sim_view_draw(struct sim_view *view, const struct iso_vec3 *vertices_mm,
                  const uint32_t (*triangles)[3], uint32_t n_triangles, enum sim_material material)
    __attribute__((warn_unused_result));

/* Sets the infrared albedo, 0..1, of the last n facets drawn, also in the companions. */
void sim_view_paint(struct sim_view *view, const float *albedo, uint32_t n);

/* Fills in `cosine` and `material` of the visible facets, also in the companions. */
void sim_view_finish(struct sim_view *view);

#endif
