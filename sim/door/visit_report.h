/* The results of the visits, for people and for programs. */
#ifndef SIM_DOOR_VISIT_REPORT_H
#define SIM_DOOR_VISIT_REPORT_H

#include <stdio.h>

#include "sim/door/visit.h"

/* Prints the heading of the table. */
void sim_visit_print_head(FILE *out);

/* Prints one line of the table: the visitor, the verdict with its numbers and its reason, and
 * whether the door was unlocked. */
void sim_visit_print(const struct sim_visit *visit, FILE *out);

/* Prints the counts and "good" or "NOT GOOD". */
void sim_visit_print_summary(const struct sim_visit_summary *summary, FILE *out);

/* Writes DIRECTORY/visits.csv:
 * recording,subject,role,note,verdict,person,score,threshold,frames,latency_ms,door,reason
 * (verdict allow, deny or none; door unlocked or locked; without a verdict the numbers and the
 * reason are empty). Errors of sim_result_file. */
int sim_visit_write_csv(const char *directory, const struct sim_visit *visits, size_t n_visits,
                        struct iso_fault *fault) __attribute__((warn_unused_result));

#endif
