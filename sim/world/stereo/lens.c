#include "sim/world/stereo/lens.h"

#include <errno.h>
#include <stdlib.h>

int sim_lens_new(const struct iso_camera *camera, struct sim_lens **out)
{
    const size_t columns = (size_t)camera->width_px + 1, rows = (size_t)camera->height_px + 1;
    struct sim_lens *lens = calloc(1, sizeof *lens);
    if (!lens) {
        return -ENOMEM;
    }
    lens->camera = *camera;
    lens->sight = malloc(columns * rows * sizeof *lens->sight);
    if (!lens->sight) {
        sim_lens_free(lens);
        return -ENOMEM;
    }
    for (size_t i = 0; i < columns * rows; i++) {
        const double u = (double)(i % columns) - 0.5, v = (double)(i / columns) - 0.5;
        struct iso_vec3 sight = iso_camera_back_project(camera, u, v, 1.0);
        lens->sight[i][0] = (float)sight.x;
        lens->sight[i][1] = (float)sight.y;
    }
    *out = lens;
    return 0;
}

void sim_lens_free(struct sim_lens *lens)
{
    if (lens) {
        free(lens->sight);
        free(lens);
    }
}

struct iso_vec3 sim_lens_sight(const struct sim_lens *lens, size_t i, double a, double b)
{
    const size_t width = (size_t)lens->camera.width_px, stride = width + 1;
    const float(*corner)[2] = (const float(*)[2])lens->sight + i / width * stride + i % width;
    double sight[2];
    for (int c = 0; c < 2; c++) {
        const double top = (1.0 - a) * (double)corner[0][c] + a * (double)corner[1][c];
        const double bottom = (1.0 - a) * (double)corner[stride][c] +
                              a * (double)corner[stride + 1][c];
        sight[c] = (1.0 - b) * top + b * bottom;
    }
    return iso_vec3(sight[0], sight[1], 1.0);
}
