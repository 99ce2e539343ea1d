/* Converts the kernel's pixel formats to planes. */
#ifndef ISO_DRIVERS_SENSOR_PICTURE_PICTURE_FORMAT_H
#define ISO_DRIVERS_SENSOR_PICTURE_PICTURE_FORMAT_H

#include "drivers/sensor/picture/picture_source.h"

/* The grey formats that iso_picture_to_grey8 reads, in the order of preference, with 0 at the end:
 * GREY, Y16, Y12, Y10, YUYV, UYVY (of the last two the luma). */
extern const uint32_t iso_picture_grey_formats[7];

/* Writes [height_px * width_px] bytes: the upper 8 of the bits that the format has. */
void iso_picture_to_grey8(const struct iso_picture *picture, uint8_t *grey);

/* The same as numbers 0..1, with all bits. */
void iso_picture_to_intensity(const struct iso_picture *picture, float *intensity);

/* Converts Z16 counts of unit_mm; 0 stays 0: not measured. */
void iso_picture_to_depth(const struct iso_picture *picture, double unit_mm, float *depth_mm);

#endif
