/* Selects the landmarks that a comparison by distance uses, for experiments. */
#ifndef SIM_LAB_MATCH_LANDMARK_CHOICE_H
#define SIM_LAB_MATCH_LANDMARK_CHOICE_H

#include <stdbool.h>

#include "isotherm/landmark.h"
#include "sim/base/options.h"

/* True for subnasale and the landmarks below it, which a mouth moves. False for the others: nasion,
 * nose tip, alae and corners of the eyes. */
extern const bool sim_landmarks_below[ISO_LANDMARKS];

/* Sets bool[ISO_LANDMARKS], true for each landmark to leave out. The text is "all" (none is left
 * out), "upper", or the names of the landmarks to keep, each once. */
sim_option_parser sim_option_landmarks;

#endif
