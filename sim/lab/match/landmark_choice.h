/* Which landmarks a comparison by distance is about, for experiments. */
#ifndef SIM_LAB_MATCH_LANDMARK_CHOICE_H
#define SIM_LAB_MATCH_LANDMARK_CHOICE_H

#include <stdbool.h>

#include "isotherm/landmark.h"
#include "sim/base/options.h"

/* What a mouth does not move, subnasale and what is below it left out: nasion, nose tip, alae and
 * corners of the eyes. */
extern const bool sim_landmarks_below[ISO_LANDMARKS];

/* bool[ISO_LANDMARKS], true for those left out: "all" (none is), "upper", or the names of those
 * that are not, each once. */
sim_option_parser sim_option_landmarks;

#endif
