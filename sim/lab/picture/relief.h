/* Depth lit from the side. Internal to sim/lab/picture. */
#ifndef SIM_LAB_PICTURE_RELIEF_H
#define SIM_LAB_PICTURE_RELIEF_H

#include "core/frame/frame.h"

/* Brightness 0.1..1 of a measured pixel as if its surface were lit from the upper left. The surface
 * is the plane through what is measured within `reach_px` (>= 1) pixels and 30 mm; the more, the
 * less noise shows. Where that gives no plane it is lit like one that faces the camera. */
float sim_relief(const struct iso_frame *frame, int column, int row, int reach_px);

#endif
