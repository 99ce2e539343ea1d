/* The simulated stereo sensor: two cameras 60 mm apart with a dot projector between them.
 *
 * The class of hardware: two monochrome global-shutter cameras of 1280 x 800 (such as OmniVision
 * OV9281) behind 2.7 mm lenses with 850 nm filters, and a laser with a diffractive element. No
 * maker publishes the noise of depth from such a rig. Assumed values are marked beside each number;
 * the errors of the depths are then measured, not assumed. */
#ifndef SIM_WORLD_STEREO_RIG_H
#define SIM_WORLD_STEREO_RIG_H

#include <stdbool.h>
#include <stdint.h>

#include "drivers/stereo/rectification.h"

struct sim_stereo_rig {
    struct iso_stereo_calibration built;    /* as the cameras really are */
    struct iso_stereo_calibration believed; /* as a calibration found them */
    struct iso_vec3 projector_mm;           /* in the left camera's frame, looking along with it */
    bool dots;                              /* the projector is on; else a lamp lights evenly */
    uint64_t dots_key;                      /* the pattern, which belongs to the projector */
    double dot_spacing;   /* mean distance of dots, tangents of angles as seen by the projector */
    double dot_radius;    /* standard deviation of a dot, the same */
    double flood_share;   /* light that the projector spreads evenly, of its whole */
    double scatter_mm;    /* standard deviation of a dot's spread within skin */
    double scatter_share; /* of a dot's light that skin spreads much farther */
    double full_well_e;   /* electrons at grey level 255 */
    double read_noise_e;  /* standard deviation */
    double right_gain;    /* of the right camera against the left */
    int samples;          /* light rays per pixel, along each axis */
};

/* How wrong the calibration is. 0: exact; 1: as good as a calibration from some 20 pictures of a
 * board is (tests/sim/world/test_calibrate.c measures it). */
struct sim_stereo_rig sim_stereo_rig(double calibration_error);

#endif
