/* The step in which a frame's depths come. Some sensors, and some recordings, report depths that
 * are whole multiples of several millimetres. Neighbouring pixels of one smooth surface then differ
 * by a whole step, although neither depth is wrong. */
#ifndef ISO_CORE_FRAME_DEPTH_STEP_H
#define ISO_CORE_FRAME_DEPTH_STEP_H

#include "isotherm/frame.h"

/* Estimates the step, mm. The function collects the differences in depth between neighbours in a
 * row, above 0 and below 20 mm. The result is their first decile: a tenth of the differences are
 * not larger. If all depths are multiples of a step, the differences are multiples of it as well,
 * and the smallest ones, of a single step, are the most frequent: the result is the step. If the
 * depths have no such step, the result is small, because many neighbours have nearly the same
 * depth. The result is rounded to a quarter of a millimetre. It is 0 if there are fewer than a
 * hundred differences. */
double iso_depth_step(const struct iso_frame *frame);

#endif
