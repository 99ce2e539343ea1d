/* The common model of sensors that triangulate, whether the second eye is a projector
 * (structured light) or a camera (stereo). Depth comes from a disparity that is measured on
 * windows. */
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
    double edge_px;  /* standard deviation of an outline's shift */
    double near_mm, far_mm; /* range of measured depths */
};

/* The model:
 *  1. Outlines shift: near a depth jump, a pixel sees the surface a correlated random step away.
 *  2. A disparity is the mean over the part of the window that lies on the same surface.
 *  3. Surface that is hidden from the second eye is not measured (shadow).
 *  4. Noise is correlated. It grows as the surface turns away (Nguyen, Izadi and Lovell 2012) and
 *     is larger on hair.
 *  5. Disparities are quantised.
 *  6. Not measured: surfaces that turn away too far, patches of hair, much of a display's glass
 *     and all of a mirror. */
void sim_triangulation_measure(const struct sim_triangulation *model, const struct sim_view *view,
                               double noise_scale, struct sim_random *random,
                               struct sim_sensor_workspace *workspace, float *depth_mm);

#endif
