/* The calibration of a metric's scores (calibration.h) in the reports of an evaluation. */
#ifndef SIM_LAB_REPORT_REPORT_CALIBRATION_H
#define SIM_LAB_REPORT_REPORT_CALIBRATION_H

#include <stdio.h>

#include "sim/lab/report/json.h"
#include "sim/lab/report/report.h"

/* Prints the measured false match rates at the scores 1 to 4 with intervals over people, Cllr, and
 * the costs at the levels. Prints nothing if they are not known. */
void sim_report_calibration(const struct sim_calibration *calibration, FILE *out);

/* The same figures and the whole curve of the promise. A new reference, or NULL. */
json_t *sim_json_calibration(const struct sim_calibration *calibration);

/* Where the site statistics come from, and the results of a split. A new reference, or NULL. */
json_t *sim_json_site(const struct sim_eval *eval);

/* Draws the measured false match rate by the promised one, both on logarithmic axes, with its
 * interval. No file is written if the rates are not known. Errors of sim_plot_write. */
int sim_report_promise(const struct sim_calibration *calibration, const char *directory,
                       const char *name, struct iso_fault *fault)
    __attribute__((warn_unused_result));

#endif
