/* A sensor's infrared image of a finished view, registered to its depth pixel by pixel.
 *
 * The model is a lamp beside the lens: the light that a matt surface returns falls with the
 * cosine of its slant (Lambert) and with the square of the distance. Shot noise and dark noise
 * are added to each pixel, and the result is rounded to counts. The dots of a pattern projector
 * lie on all surfaces, at random. Each sensor's constants are in its source in sim/world/sensor.
 * The constant of Kinect v2 was set to the brightness of real frames; the others are assumed. */
#ifndef SIM_WORLD_SENSOR_INFRARED_H
#define SIM_WORLD_SENSOR_INFRARED_H

#include <stdbool.h>

struct sim_infrared {
    double level;      /* share of full scale for a white surface that faces the sensor 1 m away */
    int bits;          /* full scale is 2^bits - 1 counts */
    double shot, dark; /* standard deviation of a pixel: sqrt(shot * intensity + dark^2) */
    double dots;       /* share of the light in the dots of a pattern */
    bool ambient;      /* the light comes from the room and does not fall off with the distance */
};

struct sim_random;
struct sim_sensor;
struct sim_sensor_workspace;
struct sim_view;

/* Fills intensity[height][width] of the sensor's size, 0..1. A sensor that takes a picture
 * itself (sim_sensor.picture) gives that picture; call the function after sim_sensor_measure
 * then. noise_scale multiplies every random error except the dots. */
void sim_infrared_measure(const struct sim_sensor *sensor, const struct sim_view *view,
                          double noise_scale, struct sim_random *random,
                          struct sim_sensor_workspace *workspace, float *intensity);

#endif
