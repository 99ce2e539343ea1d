/* The reports of an evaluation. A function with a directory writes into this directory, which must
 * exist, and replaces old files. It returns 0 or a negative errno, with a fault that names the
 * file. */
#ifndef SIM_LAB_REPORT_REPORT_H
#define SIM_LAB_REPORT_REPORT_H

#include <stdio.h>

#include "sim/lab/eval/eval.h"

/* scores.csv: every comparison with the score by which it is judged (sim_matches_compared), and
 * every probe that was not acquired; landmarks.csv: the landmarks found in every usable frame;
 * cmc.csv; det.csv; growth.csv: error rates by the number of people enrolled; curves.csv: error
 * rates by the conditions of a search. */
int sim_report_csv(const struct sim_eval *eval, const char *directory, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* summary.json */
int sim_report_json(const struct sim_eval *eval, const char *directory, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* cmc.png, det.png, scores.png, growth.png, and curve-FACTOR.png for every factor that varies;
 * promise.png and site-promise.png: the false match rates that the scores of a metric promise, and
 * those that were measured. A picture is not written if there are too few data for it. */
int sim_report_plots(const struct sim_eval *eval, const char *directory, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Prints a compact table for people. */
void sim_report_text(const struct sim_eval *eval, FILE *out);

#endif
