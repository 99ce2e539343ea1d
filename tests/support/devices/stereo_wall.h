/* A wall before a pair of cameras that stand 60 mm apart and parallel, by closed form: a smooth
 * random texture whose disparity is known. Failures fail the running cmocka test. */
#ifndef TESTS_SUPPORT_DEVICES_STEREO_WALL_H
#define TESTS_SUPPORT_DEVICES_STEREO_WALL_H

#include <stdint.h>

enum { WALL_WIDTH = 256, WALL_HEIGHT = 128, WALL_FOCAL_PX = 400, WALL_BASELINE_MM = 60 };
enum { WALL_SHIFT_MAX = 80 };

/* Writes the pair's calibration. */
void stereo_wall_write_rig(const char *path);

/* Grey level of the texture, 0..255. */
double stereo_wall_level(int x, int y);

/* The texture moved to the right by so many pixels (at most WALL_SHIFT_MAX to either side),
 * [WALL_HEIGHT * WALL_WIDTH]: the wall's distance is WALL_FOCAL_PX * WALL_BASELINE_MM / (the left
 * picture's shift - the right one's). */
void stereo_wall_picture(int shift_px, uint8_t *grey);

#endif
