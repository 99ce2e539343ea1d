/* An infrared image for a depth frame that has none: skin, brows, eyes, nostrils and mouth painted
 * on the measured surface about the landmarks that were fitted to it, under a lamp beside the lens.
 * It is coarser than what the simulator renders, and needs no head model. */
#ifndef TESTS_SUPPORT_DEVICES_PAINTED_FACE_H
#define TESTS_SUPPORT_DEVICES_PAINTED_FACE_H

#include "isotherm/frame.h"
#include "isotherm/landmark.h"

/* How bright skin at 1 m is; 0.1 is like a Kinect v2's. */
void painted_face(struct iso_frame *frame, const struct iso_vec3 ibug_mm[ISO_LANDMARKS_IBUG],
                  double level);

/* The same surface without any markings. */
void painted_blank(struct iso_frame *frame, double level);

#endif
