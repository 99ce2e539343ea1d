/* What sensors that triangulate have in common, whether the second eye is a projector (structured
 * light) or a camera (stereo): depth comes from a disparity that is measured on windows. */
#ifndef SIM_WORLD_SENSOR_TRIANGULATION_H
#define SIM_WORLD_SENSOR_TRIANGULATION_H

#include "sim/world/sensor/sensor.h"

struct sim_triangulation {
    double focal_px, baseline_mm;
    int second_eye;         /* +1: at the camera's right, x = +baseline; -1: at its left */
    int window_u, window_v; /* radius of the correlation window, px */
    double noise_px; /* standard deviation of a disparity on a frontal, matt surface, before it is
                        quantised */
    double step_px;  /* disparities come in multiples of this; 0: unquantised */
    double edge_px;  /* how far outlines wander, standard deviation */
    double near_mm, far_mm; /* nothing nearer or farther is measured */
};

/* The model:
 *  1. outlines wander: near a depth jump, a pixel sees what is there a correlated random step away;
 *  2. a disparity is the mean over the window, as far as it lies on the same surface;
 *  3. what the second eye does not see is not measured (shadow);
 *  4. correlated noise, growing as the surface turns away (Nguyen, Izadi and Lovell 2012) and on
 * hair;
 *  5. quantisation;
 *  6. surfaces that turn away too far, patches of hair, much of a display's glass and all of a
 * mirror drop out. */
void sim_triangulation_measure(const struct sim_triangulation *model, const struct sim_view *view,
                               double noise_scale, struct sim_random *random,
                               struct sim_sensor_workspace *workspace, float *depth_mm);

#endif
