/* Writes the lines of landmarks.csv. */
#ifndef SIM_LAB_REPORT_LANDMARK_LINES_H
#define SIM_LAB_REPORT_LANDMARK_LINES_H

#include <stdio.h>

#include "isotherm/extract.h"

/* Print the line of column names, and the twelve lines of a frame. Landmarks are in the camera
 * frame, mm. */
void sim_report_landmarks_header(FILE *out);
void sim_report_landmarks(const char *recording, size_t frame,
                          const struct iso_vec3 landmark_mm[ISO_LANDMARKS], FILE *out);

#endif
