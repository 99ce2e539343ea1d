/* How far a head is really turned from the camera. */
#ifndef SIM_LAB_LANDMARKS_TRUE_ANGLE_H
#define SIM_LAB_LANDMARKS_TRUE_ANGLE_H

#include "isotherm/head_model.h"
#include "sim/lab/match/truth.h"

/* The angle between where the face points and the camera's axis, yaw and pitch together:
 * cos angle = cos yaw cos pitch, 0..pi.
 *
 * From the true landmarks where at least 4 of those are known that move little with expression (all
 * but lip and mouth corners): the mean head's own are registered to them (Horn 1987). The head
 * being a mean one, this is good to a few degrees. Else from a pose of the form y+02p-04r+07
 * (degrees of yaw, pitch, roll) in the manifest. NaN if neither tells. */
double sim_true_angle(const struct iso_head_model *model, const struct sim_truth *truth,
                      const char *pose);

#endif
