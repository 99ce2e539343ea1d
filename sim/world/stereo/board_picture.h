/* Pictures of a checkerboard, as the cameras of a rig would take them. */
#ifndef SIM_WORLD_STEREO_BOARD_PICTURE_H
#define SIM_WORLD_STEREO_BOARD_PICTURE_H

#include "drivers/stereo/board.h"
#include "sim/base/random.h"
#include "sim/world/stereo/lens.h"

/* A pose in which a rig like `calibration` sees a board well: 250 to 700 mm away, turned by up to
 * 35 degrees, its middle somewhere in the left picture. It is not said that all of it is in view.
 */
struct iso_rigid sim_board_pose(const struct iso_stereo_calibration *calibration,
                                const struct iso_board *board, struct sim_random *random);

/* What a camera sees of the board (black squares on white paper with a margin of one square, grey
 * surroundings), with `noise` grey levels of random noise; 2 x 2 light rays a pixel, through the
 * lens's distortion. The board's frame is that of its corners: the first at the origin, x along
 * the columns, y along the rows. image is [height_px * width_px]. */
void sim_board_picture(const struct iso_board *board, const struct sim_lens *lens,
                       const struct iso_rigid *camera_from_board, double noise,
                       struct sim_random *random, uint8_t *image);

#endif
