/* What two grey cameras would see of the surface in a depth frame, under a projected pattern: the
 * left one stands where the depth camera stood, the right one beside it. Pure geometry, in closed
 * form of the frame: what a stereo sensor makes of the pictures can be compared with the depths. */
#ifndef TESTS_VM_USB_EYE_PAIR_H
#define TESTS_VM_USB_EYE_PAIR_H

#include <stdint.h>

#include "drivers/stereo/calibration.h"
#include "isotherm/frame.h"

enum { EYE_PAIR_BASELINE_MM = 60 };

struct eye_pair;

/* For frames of a pinhole camera without distortion. -ENOMEM. */
int eye_pair_new(const struct iso_camera *camera, struct eye_pair **out)
    __attribute__((warn_unused_result));
void eye_pair_free(struct eye_pair *pair);

/* Both cameras, as they are. */
struct iso_stereo_calibration eye_pair_calibration(const struct eye_pair *pair);

/* Fills in the pictures, [height_px * width_px] each. What has no depth is dark; `noise_key`
 * decides the noise of the pictures, a few grey levels. */
void eye_pair_look(struct eye_pair *pair, const struct iso_frame *frame, uint64_t noise_key,
                   uint8_t *left, uint8_t *right);

#endif
