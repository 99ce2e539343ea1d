/* The simulated stereo sensor: two cameras 60 mm apart with a dot projector between them.
 *
 * It stands for a class of hardware: two monochrome global-shutter cameras of 1280 x 800 (such
 * as OmniVision OV9281) behind 2.7 mm lenses with 850 nm filters, and a laser with a diffractive
 * element. No maker publishes the depth noise of such a rig. A remark beside each number says if
 * it is assumed. The errors of the depths are measured from the result, not assumed. */
#ifndef SIM_WORLD_STEREO_RIG_H
#define SIM_WORLD_STEREO_RIG_H

#include <stdbool.h>
#include <stdint.h>

#include "drivers/stereo/rectification.h"

struct sim_stereo_rig {
    struct iso_stereo_calibration built;    /* the true geometry of the cameras */
    struct iso_stereo_calibration believed; /* the geometry that a calibration found */
    struct iso_vec3 projector_mm; /* in the left camera's frame; parallel to that camera */
    bool dots;                    /* the projector is on; otherwise a lamp lights evenly */
    uint64_t dots_key;            /* the pattern, which belongs to the projector */
    double dot_spacing;   /* mean distance of dots from the projector's view, as a tangent */
    double dot_radius;    /* standard deviation of a dot, as a tangent */
    double flood_share;   /* share of the projector's light that is spread evenly */
    double scatter_mm;    /* standard deviation of a dot's spread within skin */
    double scatter_share; /* share of a dot's light that skin spreads much farther */
    double full_well_e;   /* electrons at grey level 255 */
    double read_noise_e;  /* standard deviation */
    double right_gain;    /* of the right camera relative to the left */
    int samples;          /* light rays per pixel, along each axis */
};

/* The rig. `calibration_error` scales the difference between `built` and `believed`. 0: none; 1:
 * the error of a calibration with about 20 pictures of a board (tests/sim/world/test_calibrate.c
 * measures it). */
struct sim_stereo_rig sim_stereo_rig(double calibration_error);

#endif
