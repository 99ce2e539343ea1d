/* Renders the pictures that two grey cameras would take of the surface in a depth frame, under a
 * projected pattern. The left camera is in the place of the depth camera, and the right one is next
 * to it. The pictures follow from the frame by geometry alone, so the depths that a stereo sensor
 * computes from them can be compared with those of the frame. */
#ifndef TESTS_VM_USB_EYE_PAIR_H
#define TESTS_VM_USB_EYE_PAIR_H

#include <stdint.h>

#include "drivers/stereo/calibration.h"
#include "isotherm/frame.h"

enum { EYE_PAIR_BASELINE_MM = 60 };

struct eye_pair;

/* Makes a pair for frames of a pinhole camera without distortion. -ENOMEM. */
int eye_pair_new(const struct iso_camera *camera, struct eye_pair **out)
    __attribute__((warn_unused_result));
/* Frees the pair. NULL is accepted. */
void eye_pair_free(struct eye_pair *pair);

/* The calibration of the two cameras. */
struct iso_stereo_calibration eye_pair_calibration(const struct eye_pair *pair);

/* Writes the pictures, [height_px * width_px] each. Pixels without depth are dark; `noise_key`
 * seeds the noise of the pictures, a few grey levels. */
void eye_pair_look(struct eye_pair *pair, const struct iso_frame *frame, uint64_t noise_key,
                   uint8_t *left, uint8_t *right);

#endif
