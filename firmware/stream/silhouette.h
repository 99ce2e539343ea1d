/* What is near the sensor, as a coarse silhouette in which the head is the mean head.
 *
 * The silhouette must not tell people apart. So it is sampled in cells of 4 x 4 points (20 x 15 for
 * the whole picture) and drawn with round corners. Where a face is, everything about the head is
 * left out, hair and ears too, and the outline of the mean head is filled instead. Pure. */
#ifndef ISO_FIRMWARE_STREAM_SILHOUETTE_H
#define ISO_FIRMWARE_STREAM_SILHOUETTE_H

#include <stdint.h>

#include "firmware/contract/stream_record.h"
#include "isotherm/frame.h"

/* Draws the silhouette of a frame. `outline` with n points is that of head_outline.h, distance_mm
 * is the distance of the face; n == 0: there is no face, and the distance is ignored. */
void iso_silhouette_draw(const struct iso_frame *frame, int16_t outline[][2], int n,
                         double distance_mm,
                         uint8_t bits[ISO_SILHOUETTE_ROWS][ISO_SILHOUETTE_STRIDE]);

/* The frame's depths in at most 160 x 120 points, for the record of the relief: every factor-th
 * pixel. Fills columns, rows and depths, and no other member. A depth of 65536 mm or more counts as
 * not measured. */
void iso_relief_sample(const struct iso_frame *frame, struct iso_relief_record *out);

#endif
