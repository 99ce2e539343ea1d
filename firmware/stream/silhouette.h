/* A silhouette that shows where somebody is, and not who.
 *
 * Where a face is, it is the outline of the mean head in the pose of the face, on a neck and
 * shoulders that are the same for everybody. Where something is near and no face is found, it is an
 * upright ellipse at its middle, with about its area: in cells of 4 x 4 points, and in steps of a
 * quarter in size. The silhouette of the person is not used, because it tells people apart:
 * sim/results/outlines.md has the figures. Pure. */
#ifndef ISO_FIRMWARE_STREAM_SILHOUETTE_H
#define ISO_FIRMWARE_STREAM_SILHOUETTE_H

#include <stdint.h>

#include "firmware/contract/stream_record.h"
#include "isotherm/frame.h"

/* Draws the silhouette. `outline` with n points is that of head_outline.h; n == 0: there is no
 * face, and the frame is used. */
void iso_silhouette_draw(const struct iso_frame *frame, int16_t outline[][2], int n,
                         uint8_t bits[ISO_SILHOUETTE_ROWS][ISO_SILHOUETTE_STRIDE]);

/* The frame's depths in at most 160 x 120 points, for the record of the relief: every factor-th
 * pixel. Fills columns, rows and depths, and no other member. A depth of 65536 mm or more counts as
 * not measured. */
void iso_relief_sample(const struct iso_frame *frame, struct iso_relief_record *out);

#endif
