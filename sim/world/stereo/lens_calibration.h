/* The lens of one camera from pictures of a checkerboard, as a file that `[sensor] camera` names.
 */
#ifndef SIM_WORLD_STEREO_LENS_CALIBRATION_H
#define SIM_WORLD_STEREO_LENS_CALIBRATION_H

#include <stddef.h>
#include <stdint.h>

#include "drivers/stereo/board.h"

struct sim_lens_calibration_options {
    struct iso_board board;
    const char *pictures; /* directory with *.png, 8-bit grey or RGB, all of one size */
    const char *sensor;   /* the camera's name in the file */
    double unit_mm;       /* of a count of its depth */
    const char *out;      /* file */
};

/* Calibrates, writes the file and says on standard output what was found. -ENODATA too few
 * pictures, or too much alike (iso_board_calibrate_single); -EINVAL a name or unit that cannot be;
 * errors of reading and writing. Without success there is no file. */
int sim_lens_calibrate(const struct sim_lens_calibration_options *options, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Writes n pictures that a camera of the simulated rig takes of the board to DIRECTORY/NNN.png. */
int sim_lens_pictures(const struct iso_board *board, size_t n, uint64_t seed, const char *directory,
                      struct iso_fault *fault) __attribute__((warn_unused_result));

#endif
