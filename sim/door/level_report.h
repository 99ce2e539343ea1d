/* The error rates that matter to the owner of a door, for each security level: the share of
 * visits in which enrolled people are refused, and in which strangers, or strangers who look
 * like enrolled people, are admitted. */
#ifndef SIM_DOOR_LEVEL_REPORT_H
#define SIM_DOOR_LEVEL_REPORT_H

#include <stdio.h>

#include "sim/door/rehearsal.h"
#include "sim/lab/measure/rate.h"

/* The kinds of people in a corpus. */
enum sim_level_crowd {
    SIM_CROWD_PEOPLE = 0, /* enrolled people and strangers with the usual variety */
    SIM_CROWD_ALIKE,      /* strangers who look like enrolled people */
};

/* Counted visits of one level. */
struct sim_level_counts {
    /* Enrolled people who are not admitted, or admitted under another name. */
    struct sim_rate refused;
    struct sim_rate strangers; /* admitted strangers */
    struct sim_rate alike;     /* admitted strangers who look like enrolled people */
};

/* Adds the visits of one corpus at one level. From SIM_CROWD_ALIKE only the strangers count. */
void sim_level_count(enum sim_level_crowd crowd, const struct sim_visit *visits, size_t n_visits,
                     struct sim_level_counts *counts);

/* Prints a table in Markdown with a row for each level: rates in percent, exact 95 % intervals
 * (sim_rate_exact_interval) and counts. */
void sim_level_print(const struct sim_level_counts counts[SIM_LEVELS], FILE *out);

/* Writes DIRECTORY/levels.csv: level,who,errors,visits,rate,low,high. `who` is refused,
 * strangers or alike; the last three are fractions. The errno of writing. */
int sim_level_write_csv(const char *directory, const struct sim_level_counts counts[SIM_LEVELS],
                        struct iso_fault *fault) __attribute__((warn_unused_result));

#endif
