/* Which pixels of a frame agree with their surroundings. Internal to core/surface. */
#ifndef ISO_CORE_SURFACE_AGREEING_H
#define ISO_CORE_SURFACE_AGREEING_H

/* A pixel that differs by more, mm, from a neighbour or from the median is not on the same surface.
 */
struct iso_agreeing_bounds {
    float neighbour_mm, median_mm;
};

/* Floats behind a plane that may be read, because the last pixels of a row are treated as if the
 * row were longer. */
enum { ISO_AGREEING_SLACK = 8 };

/* Writes the depths that agree to kept [height_px * width_px], and 0 for the others and within two
 * pixels of the border. A depth agrees if at least five of its eight neighbours differ by less than
 * one bound, and the median of its 5 x 5 surroundings by no more than the other one. depth_mm has
 * the same shape and ISO_AGREEING_SLACK floats behind it; width and height are at least 4 pixels.
 * The functions give the same results to the bit. */
typedef void iso_agreeing_function(const float *depth_mm, int width_px, int height_px,
                                   struct iso_agreeing_bounds bounds, float *kept);

iso_agreeing_function iso__keep_agreeing_baseline;
iso_agreeing_function iso__keep_agreeing_avx2; /* x86-64 only */
iso_agreeing_function iso_keep_agreeing;       /* the fastest one that this machine can run */

#endif
