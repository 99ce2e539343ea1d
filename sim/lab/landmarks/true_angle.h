/* The true angle between a head and the camera's axis. */
#ifndef SIM_LAB_LANDMARKS_TRUE_ANGLE_H
#define SIM_LAB_LANDMARKS_TRUE_ANGLE_H

#include "isotherm/head_model.h"
#include "sim/lab/match/truth.h"

/* The angle between the direction of the face and the camera's axis, from yaw and pitch together:
 * cos angle = cos yaw cos pitch, 0..pi.
 *
 * It is computed from the landmarks that move little with expression (all except upper lip and
 * mouth corners), if at least 4 of them are known: the mean head's landmarks are registered to
 * them (Horn 1987). The result is accurate to a few degrees, because the mean head is not the
 * person's. If fewer are known, the angle comes from the manifest's pose of the form y+02p-04r+07
 * (degrees of yaw, pitch, roll). NaN if neither is available. */
double sim_true_angle(const struct iso_head_model *model, const struct sim_truth *truth,
                      const char *pose);

#endif
