#include "tests/sim/world/sensor_bench.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "sim/world/prop/solid.h"

struct sensor_bench sensor_bench_set_up(const struct sim_sensor *sensor)
{
    struct sensor_bench b = {.sensor = sensor};
    const struct iso_camera *camera = &sensor->camera;
    assert_int_equal(sim_view_new(camera, sensor->supersample, &b.view), 0);
    assert_int_equal(sim_sensor_workspace_new(sensor, &b.workspace), 0);
    assert_int_equal(iso_frame_new(camera, camera->width_px, camera->height_px, false, &b.frame),
                     0);
    return b;
}

void sensor_bench_tear_down(struct sensor_bench *bench)
{
    sim_view_free(bench->view);
    sim_sensor_workspace_free(bench->workspace);
    iso_frame_free(bench->frame);
}

void sensor_bench_put(struct sensor_bench *bench, double width_mm, double height_mm, double z_mm,
                      struct iso_vec3 turn_rad, enum sim_material material)
{
    struct sim_solid *card;
    struct iso_vec3 scratch[256];
    struct iso_rigid placed = {iso_mat3_rotation(turn_rad), {0.0, 0.0, z_mm}};
    assert_int_equal(sim_solid_rectangle(width_mm, height_mm, 0.0, material, &card), 0);
    assert_int_equal(sim_solid_draw(card, &placed, scratch, bench->view), 0);
    sim_solid_free(card);
}
