/* A sensor's infrared image of a finished view, registered to its depth pixel by pixel.
 *
 * A lamp beside the lens: what comes back from a matt surface falls with the cosine of its slant
 * (Lambert) and the square of the distance. Each pixel then has shot and dark noise and is rounded
 * to counts. A pattern projector's dots lie on everything, at random. Constants of the sensors
 * stand with them in sim/world/sensor; that of Kinect v2 was set to the brightness of real frames,
 * the others are assumed. */
#ifndef SIM_WORLD_SENSOR_INFRARED_H
#define SIM_WORLD_SENSOR_INFRARED_H

#include <stdbool.h>

struct sim_infrared {
    double level;      /* share of full scale of a white surface 1 m away that faces the sensor */
    int bits;          /* full scale is 2^bits - 1 counts */
    double shot, dark; /* standard deviation of a pixel: sqrt(shot * intensity + dark^2) */
    double dots;       /* share of the light that is in the dots of a pattern */
    bool ambient;      /* light comes from the room: no fall-off with the distance */
};

struct sim_random;
struct sim_sensor;
struct sim_sensor_workspace;
struct sim_view;

/* Fills intensity[height][width] of the sensor's size, 0..1; with the picture itself, if the sensor
 * takes one (sim_sensor.picture: call it after sim_sensor_measure). noise_scale multiplies every
 * random error but the dots. */
void sim_infrared_measure(const struct sim_sensor *sensor, const struct sim_view *view,
                          double noise_scale, struct sim_random *random,
                          struct sim_sensor_workspace *workspace, float *intensity);

#endif
