/* The step in which a frame's depths come. Some sensors, and some recordings, report depths that
 * are whole multiples of several millimetres. Neighbouring pixels of one smooth surface then differ
 * by a whole step, although neither depth is wrong. */
#ifndef ISO_CORE_FRAME_DEPTH_STEP_H
#define ISO_CORE_FRAME_DEPTH_STEP_H

#include "isotherm/frame.h"

/* Estimates the step, mm. The function computes the differences in depth between neighbouring
 * pixels of each row. It keeps the differences that are larger than 0 and smaller than 20 mm, and
 * sorts them. The result is their first decile, rounded to a quarter of a millimetre.
 *
 * Some sensors round each depth to a multiple of a step. Then no difference that is kept is smaller
 * than the step, and most of them are equal to it. Therefore the first decile is the step. Other
 * sensors do not round. Then many neighbours have nearly the same depth, and the result is small.
 * The result is 0 if there are fewer than a hundred differences. */
double iso_depth_step(const struct iso_frame *frame);

#endif
