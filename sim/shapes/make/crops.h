/* The things before a depth sensor as a corpus of shapes, to test whether methods that know nothing
 * of faces can tell a face from a thing.
 *
 * The nearest thing is cut out of a frame, in the same way whatever it is: the middle of all that
 * lies at most 80 mm behind the nearest hundredth of the measured pixels, and of what is within
 * 100 mm of that, cleaned, at 4 mm a pixel, the largest piece, seen from the front: x right, y up,
 * z towards the sensor, mm. The extractor has no part in it.
 *
 * Crops of recordings of real people are biometric data, as those are. */
#ifndef SIM_SHAPES_MAKE_CROPS_H
#define SIM_SHAPES_MAKE_CROPS_H

#include <stddef.h>
#include <stdint.h>

#include "core/base/fault.h"
#include "sim/base/options.h"

struct sim_crops_options {
    struct sim_option_texts corpora; /* directories of recordings */
    const char *out;                 /* directory, made if it is missing */
    size_t rows;                     /* of each corpus, evenly spread over its manifest; 0: all */
};

/* Writes OFF files and manifest.csv, class `face` or, for subject `none`, `not-face`; of each row
 * the first frame. *n_written: how many shapes, *n_empty: frames with too little in them. -EINVAL
 * without a corpus; errors of reading and writing; -ENOMEM; each with a fault. */
int sim_crops_write(const struct sim_crops_options *options, int32_t *n_written, int32_t *n_empty,
                    struct iso_fault *fault) __attribute__((warn_unused_result));

#endif
