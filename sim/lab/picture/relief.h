/* A frame as a relief: depth lit from the side, and where points appear in it. Internal to
 * sim/lab/picture. */
#ifndef SIM_LAB_PICTURE_RELIEF_H
#define SIM_LAB_PICTURE_RELIEF_H

#include <stdbool.h>

#include "isotherm/frame.h"

/* Brightness 0.1..1 of a measured pixel as if its surface were lit from the upper left. The surface
 * is the plane through what is measured within `reach_px` (>= 1) pixels and 30 mm; the more, the
 * less noise shows. Where that gives no plane it is lit like one that faces the camera. */
float sim_relief(const struct iso_frame *frame, int column, int row, int reach_px);

/* Where a point of the camera frame appears, in pixels of the frame, whose upper left pixel here
 * reaches from (0, 0) to (1, 1). False for a point that the camera does not see. */
bool sim_relief_place(const struct iso_frame *frame, struct iso_vec3 point_mm, double *x,
                      double *y);

/* The smallest measured depth, or infinity if nothing was measured. */
double sim_relief_nearest_mm(const struct iso_frame *frame);

/* How many pixels about one of this depth sim_relief should take into account: about 8 mm in
 * all. */
int sim_relief_reach_px(const struct iso_frame *frame, double depth_mm);

#endif
