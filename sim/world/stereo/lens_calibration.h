/* Calibrates the lens of one camera from pictures of a checkerboard, and writes the file that
 * `[sensor] camera` names. */
#ifndef SIM_WORLD_STEREO_LENS_CALIBRATION_H
#define SIM_WORLD_STEREO_LENS_CALIBRATION_H

#include <stddef.h>
#include <stdint.h>

#include "drivers/stereo/board.h"

struct sim_lens_calibration_options {
    struct iso_board board;
    const char *pictures; /* directory with *.png, 8-bit grey or RGB, all of one size */
    const char *sensor;   /* the camera's name in the file */
    double unit_mm;       /* of one depth count */
    const char *out;      /* file */
};

/* Calibrates, writes the file and prints the result on standard output. -ENODATA: too few
 * pictures, or pictures that are too similar (iso_board_calibrate_single). -EINVAL: an invalid
 * name or unit. Otherwise an error of reading or writing. No file is written on failure. */
int sim_lens_calibrate(const struct sim_lens_calibration_options *options, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Writes n pictures of the board, taken by a camera of the simulated rig, to DIRECTORY/NNN.png. */
int sim_lens_pictures(const struct iso_board *board, size_t n, uint64_t seed, const char *directory,
                      struct iso_fault *fault) __attribute__((warn_unused_result));

#endif
