/* Calibrates a camera or a pair of cameras with pictures of a checkerboard. Corners are found to a
 * fraction of a pixel; each camera is solved for by itself (Zhang 2000), then both together. */
#ifndef ISO_DRIVERS_STEREO_BOARD_H
#define ISO_DRIVERS_STEREO_BOARD_H

#include <stdint.h>

#include "drivers/stereo/calibration.h"

/* A flat checkerboard. Its corners are the points at which four squares meet. If the number of them
 * is odd in one direction and even in the other, the board looks different after half a turn. */
struct iso_board {
    int columns, rows; /* of corners: 3..64 each */
    double square_mm;  /* 1..1000 */
};

enum { ISO_BOARD_PAIRS_MIN = 6 };

struct iso_board_views;

/* An empty collection for pictures of one size. -EINVAL with *fault for a board or size out of
 * range, -ENOMEM, the errors of iso_stereo_module_load. */
int iso_board_views_new(const struct iso_board *board, int width_px, int height_px,
                        struct iso_board_views **out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Frees it and what it holds. NULL is accepted. */
void iso_board_views_free(struct iso_board_views *views);

/* Adds two 8-bit pictures that were taken at the same moment, [height_px * width_px] each. -ENOENT
 * if one of them does not show the whole board: nothing is added. -ENOMEM, -EIO. */
int iso_board_views_add(struct iso_board_views *views, const uint8_t *left, const uint8_t *right)
    __attribute__((warn_unused_result));

/* The number of pairs, or of single pictures. */
int iso_board_views_count(const struct iso_board_views *views);

/* The number of parts of solving for a pair: the left camera, the right one, both together. */
enum { ISO_BOARD_SOLUTIONS = 3 };

/* Solves for a pair of cameras. `solved`, unless it is NULL, is called with `context` after each
 * part, by the calling thread. Radial distortion is k1 and k2; k3 is 0. -ENODATA with *fault for
 * fewer than ISO_BOARD_PAIRS_MIN pairs, or if the result cannot be a pair of cameras (too few
 * directions, left and right swapped, another board); -ENOMEM, -EIO. */
int iso_board_calibrate(const struct iso_board_views *views, void (*solved)(void *context),
                        void *context, struct iso_stereo_calibration *out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* ---- one camera ---- */

enum { ISO_BOARD_VIEWS_MIN = 8 };

/* The result for one camera. */
struct iso_board_lens {
    struct iso_camera camera;
    int views;
    double rms_px; /* between the corners and the model */
};

/* Adds one 8-bit picture of one camera. A collection has pairs or single pictures, not both.
 * Errors of iso_board_views_add. */
int iso_board_views_add_single(struct iso_board_views *views, const uint8_t *image)
    __attribute__((warn_unused_result));

/* Solves for one camera (Zhang 2000); radial distortion is k1 and k2. -ENODATA with *fault for
 * fewer than ISO_BOARD_VIEWS_MIN pictures that differ, boards that are hardly turned or cover
 * little of the picture, corners that differ from the model by more than 1 px (root mean square),
 * or a result that cannot be a camera; -ENOMEM, -EIO. */
int iso_board_calibrate_single(const struct iso_board_views *views, struct iso_board_lens *out,
                               struct iso_fault *fault) __attribute__((warn_unused_result));

#endif
