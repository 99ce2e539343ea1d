/* What a pixel of a time-of-flight sensor receives from a scene: the part of the model that all
 * such sensors share. */
#ifndef SIM_WORLD_SENSOR_TIME_OF_FLIGHT_H
#define SIM_WORLD_SENSOR_TIME_OF_FLIGHT_H

#include "sim/world/view/view.h"

struct sim_mixed_pixel {
    double depth_mm;  /* mean depth of the surfaces in the pixel, weighted by amplitude; 0: none */
    double amplitude; /* mean amplitude; 1: a white surface that faces the sensor */
    double spread_mm; /* from the nearest to the farthest surface in the pixel */
};

/* Combines the samples of the view that lie in a pixel of the sensor. It also takes the next
 * `reach` samples on each side, as a lens does that is not sharp (0: the pixel alone). A pixel on
 * an outline has a depth between the surfaces: Sarbolandi, Lefloch and Kolb, "Kinect Range
 * Sensing", CVIU 139 (2015). The albedos in the near infrared are assumed. */
struct sim_mixed_pixel sim_time_of_flight_mix(const struct sim_view *view, int column, int row,
                                              int reach);

#endif
