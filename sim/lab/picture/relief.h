/* A frame as a relief: depth lit from the side, and the positions of points in it. Internal to
 * sim/lab/picture. */
#ifndef SIM_LAB_PICTURE_RELIEF_H
#define SIM_LAB_PICTURE_RELIEF_H

#include <stdbool.h>

#include "isotherm/frame.h"

/* Brightness 0.1..1 of a measured pixel as if its surface were lit from the upper left. The
 * surface is the plane through the measured pixels within `reach_px` (>= 1) pixels and 30 mm; a
 * larger reach shows less noise. Where there is no such plane, the pixel is lit as if it faced
 * the camera. */
float sim_relief(const struct iso_frame *frame, int column, int row, int reach_px);

/* Position of a point of the camera frame in pixels of the frame; the upper left pixel reaches
 * from (0, 0) to (1, 1). False for a point that the camera does not see. */
bool sim_relief_place(const struct iso_frame *frame, struct iso_vec3 point_mm, double *x,
                      double *y);

/* The smallest measured depth, or infinity if nothing was measured. */
double sim_relief_nearest_mm(const struct iso_frame *frame);

/* The number of pixels that sim_relief should use around a pixel of this depth: about 8 mm in
 * all. */
int sim_relief_reach_px(const struct iso_frame *frame, double depth_mm);

#endif
