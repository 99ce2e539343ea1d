/* A wall before two parallel cameras 60 mm apart. Its smooth random texture has a closed formula,
 * and its disparity is known. Failures fail the running cmocka test. */
#ifndef TESTS_SUPPORT_DEVICES_STEREO_WALL_H
#define TESTS_SUPPORT_DEVICES_STEREO_WALL_H

#include <stdint.h>

enum { WALL_WIDTH = 256, WALL_HEIGHT = 128, WALL_FOCAL_PX = 400, WALL_BASELINE_MM = 60 };
enum { WALL_SHIFT_MAX = 80 };

/* Writes the calibration of the two cameras. */
void stereo_wall_write_rig(const char *path);

/* Grey level of the texture, 0..255. */
double stereo_wall_level(int x, int y);

/* Makes a picture [WALL_HEIGHT * WALL_WIDTH] of the texture, moved to the right by a number of
 * pixels (at most WALL_SHIFT_MAX to either side). The distance of the wall is WALL_FOCAL_PX *
 * WALL_BASELINE_MM / (shift of the left picture - shift of the right picture). */
void stereo_wall_picture(int shift_px, uint8_t *grey);

#endif
