/* How high a place of a coarse frame is above a ring of 40 mm about it: a measure of noses. */
#ifndef ISO_CORE_FIND_RING_HEIGHT_H
#define ISO_CORE_FIND_RING_HEIGHT_H

#include "isotherm/frame.h"

/* Lower places are no noses. */
#define ISO_RING_HEIGHT_MIN_MM 7.0

/* The height of a pixel towards the camera, mm, above the least-squares plane through its ring,
 * along the normal of the plane. z_mm is the depth of the pixel, smoothed. 0 if the height is
 * certainly less than ISO_RING_HEIGHT_MIN_MM, or if too few points of the ring were measured. */
double iso_ring_height(const struct iso_frame *frame, int column, int row, double z_mm);

/* How far a place stands out of its wide surroundings: how far a ring of 90 mm about it lies behind
 * it on average, mm. That ring passes along the border of a face. Points outside the frame do not
 * count, unless almost all are; the others count from -40 to 80 mm, and 80 mm if they were not
 * measured. */
double iso_ring_stands_out(const struct iso_frame *frame, int column, int row, double z_mm);

#endif
