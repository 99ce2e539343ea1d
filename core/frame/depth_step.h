/* The step in which a frame's depths come. Some sensors, and some recordings, report depths that
 * are whole multiples of several millimetres. Neighbouring pixels of one smooth surface then differ
 * by a whole step, which is no sign of an error. */
#ifndef ISO_CORE_FRAME_DEPTH_STEP_H
#define ISO_CORE_FRAME_DEPTH_STEP_H

#include "isotherm/frame.h"

/* The step, mm: a tenth of those depth differences between neighbours in a row that are above 0 and
 * below 20 mm are at most as large as this. Where depths are multiples of a step, all of these
 * differences are, and the result is the step. Where they are not, the result is small, because
 * many neighbours differ by little. Rounded to a quarter of a millimetre; 0 if there are fewer than
 * a hundred differences. */
double iso_depth_step(const struct iso_frame *frame);

#endif
