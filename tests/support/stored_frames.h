/* A small recording that this file writes itself, without the product's writer: tests compare the
 * two. It has 7 x 5 pixels, the unit 0.5 mm, and frame f at time 10 + f / 8 s. The depth count at
 * (column, row) of frame f is 1000 + 100 f + 10 row + column, except that pixel (0, 0) is not
 * measured. */
#ifndef TESTS_SUPPORT_STORED_FRAMES_H
#define TESTS_SUPPORT_STORED_FRAMES_H

#include <stdbool.h>

enum { STORED_WIDTH = 7, STORED_HEIGHT = 5 };

extern const char stored_ini[];

/* Makes the directory and writes the recording. */
void stored_frames_write(const char *directory, int n_frames);

/* The same frames as a camera of OpenNI 2 can make them: with another unit, without distortion, and
 * with the principal point in the middle. If asked for, with ir/: the 16-bit count at (column, row)
 * of frame f is 3000 + 500 f + 70 row + column. */
void stored_frames_write_plain(const char *directory, int n_frames, double unit_mm, bool with_ir);

/* Writes one plane of constant samples: `bits` 8 or 16, `channels` 1 or 3. */
void stored_plane_write(const char *path, int width, int height, int bits, int channels,
                        unsigned value);

#endif
