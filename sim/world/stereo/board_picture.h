/* Renders pictures of a checkerboard as the cameras of a rig take them. */
#ifndef SIM_WORLD_STEREO_BOARD_PICTURE_H
#define SIM_WORLD_STEREO_BOARD_PICTURE_H

#include "drivers/stereo/board.h"
#include "sim/base/random.h"
#include "sim/world/stereo/lens.h"

/* A pose in which a rig like `calibration` sees a board well: 250 to 700 mm away, turned by up
 * to 35 degrees, its middle somewhere in the left picture. Parts of the board may be outside the
 * picture. */
struct iso_rigid sim_board_pose(const struct iso_stereo_calibration *calibration,
                                const struct iso_board *board, struct sim_random *random);

/* Draws the board as a camera sees it: black squares on white paper with a margin of one square,
 * grey surroundings, and `noise` grey levels of random noise. Each pixel takes 2 x 2 light rays
 * through the lens's distortion. The board's frame: the first corner is at the origin, x runs along
 * a row of corners, y along a column. image is [height_px * width_px]. */
void sim_board_picture(const struct iso_board *board, const struct sim_lens *lens,
                       const struct iso_rigid *camera_from_board, double noise,
                       struct sim_random *random, uint8_t *image);

#endif
