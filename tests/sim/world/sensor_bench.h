/* A sensor model in front of cards of known size and place. */
#ifndef TESTS_SIM_WORLD_SENSOR_BENCH_H
#define TESTS_SIM_WORLD_SENSOR_BENCH_H

#include "sim/world/sensor/sensor.h"

struct sensor_bench {
    const struct sim_sensor *sensor;
    struct sim_view *view;
    struct sim_sensor_workspace *workspace;
    struct iso_frame *frame;
};

/* Makes a bench with an empty view. A failure fails the running test. */
struct sensor_bench sensor_bench_set_up(const struct sim_sensor *sensor);
/* Frees what the bench holds. */
void sensor_bench_tear_down(struct sensor_bench *bench);

/* Adds a card to the view. Its centre is on the axis; the rotation vector `turn_rad` turns it. */
void sensor_bench_put(struct sensor_bench *bench, double width_mm, double height_mm, double z_mm,
                      struct iso_vec3 turn_rad, enum sim_material material);

#endif
