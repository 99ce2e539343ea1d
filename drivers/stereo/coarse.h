/* Makes a first guess of the disparity at every pixel from disparities at half size. It fits planes
 * to neighbourhoods, which smooths the matcher's steps and bridges its small gaps. */
#ifndef ISO_DRIVERS_STEREO_COARSE_H
#define ISO_DRIVERS_STEREO_COARSE_H

/* half_px: [(height_px/2) * (width_px/2)] disparities in pixels of the whole image, 0: none.
 * whole_px: [height_px * width_px], the same. At each half-size pixel a plane is fitted by least
 * squares to the 5 x 5 values around it that lie within 2 px of their median; with fewer than 8 of
 * them there is no guess. width_px and height_px are even. */
void iso_coarse_spread(const float *half_px, int width_px, int height_px, float *whole_px);

#endif
