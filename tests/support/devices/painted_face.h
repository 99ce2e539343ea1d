/* Makes an infrared image for a depth frame without one: it paints skin, brows, eyes, nostrils and
 * mouth on the measured surface, about the fitted landmarks, under a lamp next to the lens. The
 * image is coarser than the simulator's, but it needs no head model. */
#ifndef TESTS_SUPPORT_DEVICES_PAINTED_FACE_H
#define TESTS_SUPPORT_DEVICES_PAINTED_FACE_H

#include "isotherm/frame.h"
#include "isotherm/landmark.h"

/* Paints the frame's image. `level` is the brightness of skin at 1 m; 0.1 is that of a Kinect v2.
 * The landmarks are in the camera frame. */
void painted_face(struct iso_frame *frame, const struct iso_vec3 ibug_mm[ISO_LANDMARKS_IBUG],
                  double level);

/* The same surface without any markings. */
void painted_blank(struct iso_frame *frame, double level);

#endif
