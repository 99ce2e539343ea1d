/* Makes a corpus of shapes from the objects in front of a depth sensor, to test whether methods
 * without knowledge of faces can tell a face from other objects.
 *
 * The nearest object is cut out of a frame, always in the same way. Start with the pixels at most
 * 80 mm behind the nearest hundredth of the measured pixels, and take their middle. Keep the pixels
 * within 100 mm of it, clean them, resample at 4 mm for each pixel and keep the largest piece. The
 * view is from the front: x right, y up, z towards the sensor, mm. The extractor is not used.
 *
 * Crops of recordings of real people are biometric data, like the recordings. */
#ifndef SIM_SHAPES_MAKE_CROPS_H
#define SIM_SHAPES_MAKE_CROPS_H

#include <stddef.h>
#include <stdint.h>

#include "core/base/fault.h"
#include "sim/base/options.h"

struct sim_crops_options {
    struct sim_option_texts corpora; /* directories of recordings */
    const char *out;                 /* directory, created if it is missing */
    size_t rows;                     /* of each corpus, evenly spread over its manifest; 0: all */
};

/* Writes OFF files and manifest.csv with class `face` or, for subject `none`, `not-face`. Only
 * the first frame of each row is used. *n_written: number of shapes; *n_empty: frames without an
 * object or with too few pixels of it. -EINVAL without a corpus; errors of reading and writing;
 * -ENOMEM; each with a fault. */
int sim_crops_write(const struct sim_crops_options *options, int32_t *n_written, int32_t *n_empty,
                    struct iso_fault *fault) __attribute__((warn_unused_result));

#endif
