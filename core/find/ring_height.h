/* How high a place of a coarse frame is above a ring of 40 mm about it: a measure of noses. */
#ifndef ISO_CORE_FIND_RING_HEIGHT_H
#define ISO_CORE_FIND_RING_HEIGHT_H

#include "isotherm/frame.h"

/* Lower places are no noses. */
#define ISO_RING_HEIGHT_MIN_MM 7.0

/* Where the columns and rows of a frame look: x / z of each column and y / z of each row, so that
 * no point of a ring needs a division. Only for pinhole cameras without distortion; otherwise NULL.
 */
struct iso_sight_lines {
    const double *column, *row;
};

/* The same quotient for a column; the same for a row with cy_px and fy_px. */
static inline double iso_sight_line(int pixel, int crop_px, double centre_px, double focal_px)
{
    return (pixel + crop_px - centre_px) / focal_px;
}

/* The height of a pixel towards the camera, mm, above the least-squares plane through its ring,
 * along the normal of the plane. z_mm is the depth of the pixel, smoothed. 0 if the height is
 * certainly less than ISO_RING_HEIGHT_MIN_MM, or if too few points of the ring were measured. */
double iso_ring_height(const struct iso_frame *frame, const struct iso_sight_lines *lines,
                       int column, int row, double z_mm);

/* The pixels that iso_rings_are_low() judges at once. */
enum { ISO_RINGS = 4 };

/* Judges ISO_RINGS pixels of a row, from `column` on, by four points of each one's ring. The pixels
 * have to lie within the frame. Bit k is set only if the height of pixel `column` + k is certainly
 * less than ISO_RING_HEIGHT_MIN_MM; then iso_ring_height() of this pixel is 0. z_mm has the depths
 * of the pixels, smoothed. */
unsigned iso_rings_are_low(const struct iso_frame *frame, int column, int row,
                           const double z_mm[ISO_RINGS]);

/* How far a place stands out of its wide surroundings: how far a ring of 90 mm about it lies behind
 * it on average, mm. That ring passes along the border of a face. Points outside the frame do not
 * count, unless almost all are; the others count from -40 to 80 mm, and 80 mm if they were not
 * measured. */
double iso_ring_stands_out(const struct iso_frame *frame, int column, int row, double z_mm);

#endif
