#include "sim/world/stereo/board_picture.h"

#include <stddef.h>

static const double black = 25.0, white = 210.0, surroundings = 90.0;

struct iso_rigid sim_board_pose(const struct iso_stereo_calibration *calibration,
                                const struct iso_board *board, struct sim_random *random)
{
    const struct iso_camera *camera = &calibration->camera[ISO_EYE_LEFT];
    const double pitch = sim_random_between(random, -0.6, 0.6);
    const double yaw = sim_random_between(random, -0.6, 0.6);
    struct iso_mat3 turn = iso_mat3_rotation(
        iso_vec3(pitch, yaw, sim_random_between(random, -0.3, 0.3)));
    const double z_mm = sim_random_between(random, 250.0, 700.0);
    const double u = camera->width_px * sim_random_between(random, 0.25, 0.75);
    const double v = camera->height_px * sim_random_between(random, 0.25, 0.75);
    struct iso_vec3 middle = {0.5 * (board->columns - 1) * board->square_mm,
                              0.5 * (board->rows - 1) * board->square_mm, 0.0};
    struct iso_vec3 at = iso_camera_back_project(camera, u, v, z_mm);
    return (struct iso_rigid){turn, iso_sub(at, iso_mat3_apply(&turn, middle))};
}

/* Grey level of the board's plane at (x, y), in squares from the first corner. */
static double level_at(const struct iso_board *board, double x, double y)
{
    if (x < -2.0 || y < -2.0 || x >= board->columns + 1.0 || y >= board->rows + 1.0) {
        return surroundings;
    }
    if (x < -1.0 || y < -1.0 || x >= board->columns || y >= board->rows) {
        return white;
    }
    const long square = (long)floor(x) + (long)floor(y);
    return square & 1 ? white : black;
}

void sim_board_picture(const struct iso_board *board, const struct sim_lens *lens,
                       const struct iso_rigid *camera_from_board, double noise,
                       struct sim_random *random, uint8_t *image)
{
    enum { RAYS = 2 };
    struct iso_rigid board_from_camera = iso_rigid_inverse(camera_from_board);
    struct iso_vec3 eye = board_from_camera.translation_mm;
    const size_t n = (size_t)lens->camera.width_px * (size_t)lens->camera.height_px;
    for (size_t i = 0; i < n; i++) {
        double sum = 0.0;
        for (int k = 0; k < RAYS * RAYS; k++) {
            const double a = (k % RAYS + 0.5) / RAYS, b = ((double)(k / RAYS) + 0.5) / RAYS;
            struct iso_vec3 ray = iso_mat3_apply(&board_from_camera.rotation,
                                                 sim_lens_sight(lens, i, a, b));
            const double t = -eye.z / ray.z;
            struct iso_vec3 at = iso_scale(1.0 / board->square_mm, iso_madd(eye, t, ray));
            sum += t > 0.0 ? level_at(board, at.x, at.y) : surroundings;
        }
        const double level = sum / (RAYS * RAYS) + noise * sim_random_normal(random);
        image[i] = (uint8_t)fmin(fmax(nearbyint(level), 0.0), 255.0);
    }
}
