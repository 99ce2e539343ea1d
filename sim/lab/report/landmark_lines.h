/* Result files. */
#ifndef SIM_LAB_REPORT_LANDMARK_LINES_H
#define SIM_LAB_REPORT_LANDMARK_LINES_H

#include <stdio.h>

#include "core/base/fault.h"
#include "isotherm/extract.h"

/* Writes what a file is to contain. */
typedef void sim_report_writer(const void *context, FILE *out);

/* Writes DIRECTORY/NAME, replacing it. -ENAMETOOLONG, -EIO or the errno of opening it, each with a
 * fault that names the file. */
int sim_report_file(const char *directory, const char *name, sim_report_writer *writer,
                    const void *context, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* landmarks.csv: the line of column names, and the twelve rows of a frame. */
void sim_report_landmarks_header(FILE *out);
void sim_report_landmarks(const char *recording, size_t frame,
                          const struct iso_vec3 landmark_mm[ISO_LANDMARKS], FILE *out);

#endif
