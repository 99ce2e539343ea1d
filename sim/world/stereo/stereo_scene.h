/* The pair of pictures that the two cameras of a rig take of a scene. */
#ifndef SIM_WORLD_STEREO_STEREO_SCENE_H
#define SIM_WORLD_STEREO_STEREO_SCENE_H

#include "sim/base/random.h"
#include "sim/world/stereo/light.h"

struct sim_stereo_scene;

/* Makes the three eyes (two cameras and the projector) of a rig, which is copied. The view that
 * they are attached to must be in the frame of the rectified left camera of the believed
 * calibration. -ENOMEM. */
int sim_stereo_scene_new(const struct sim_stereo_rig *rig, struct sim_stereo_scene **out)
    __attribute__((warn_unused_result));

/* Frees it and what it holds. NULL is accepted. */
void sim_stereo_scene_free(struct sim_stereo_scene *scene);

/* Makes the eyes companions of a view. The scene must outlive the view. */
void sim_stereo_scene_attach(struct sim_stereo_scene *scene, struct sim_view *view);

/* Exposes both cameras to the content of the finished view. The exposure is such that a fiftieth of
 * the middle of the left picture is brighter than grey level 200. Light noise and sensor noise,
 * times noise_scale, are drawn from `random`. Images are [height_px * width_px]. `key` determines
 * the textures. */
void sim_stereo_scene_expose(struct sim_stereo_scene *scene, uint64_t key, double noise_scale,
                             struct sim_random *random, uint8_t *left, uint8_t *right);

#endif
